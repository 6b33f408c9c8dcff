// Finding the seams of traced pieces through the mesh, following their sides, and their notches:
// marks on both sides of a seam that meet when it is sewn.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// A stretch of outline that keeps its ends when outlines are simplified: both sides of a seam, or
/// one side of open boundary (side_count 1). Both sides have the same number of edges.
struct Chain {
    std::array<SeamSide, 2> sides;
    int side_count = 2;
    bool is_dart = false;
    bool is_closed = false;
    bool is_cut = false;         // made to split a piece
    double surface_length = 0.0; // mm
    // #count: length that each edge has on the model, in mm; when vertices are left out, as much
    // shorter as the outlines on paper become, in the mean of both sides.
    std::vector<double> true_length;

    Index count() const { return sides[0].count; }
};

/// All chains of traced pieces, in the order of the pieces and their outlines: maximal runs of
/// edges that face the same other run. Every edge of every outline belongs to one chain. `cut`
/// (3 #F, may be empty): 1 where pieces were split.
std::vector<Chain> find_chains(const Mesh& mesh, const std::vector<PatternPiece>& pieces,
                               const std::vector<std::uint8_t>& cut);

/// Sets surface_length and true_length of all chains; `mm` is the length of the mesh's internal
/// unit on paper.
void measure_surface(const Mesh& mesh, const std::vector<PatternPiece>& pieces, double mm,
                     std::vector<Chain>& chains);

/// Point k of a side, 0 … count, from the seam's start.
Vec2 side_point(const std::vector<PatternPiece>& pieces, const SeamSide& side, Index k);

/// The part of a chain between its points `from` and `to`; beyond the end on closed chains.
Chain part_of(const std::vector<PatternPiece>& pieces, const Chain& chain, Index from, Index to);

/// Leaves only the given points of every chain in the outlines: kept[c] holds points of chain c in
/// ascending order, its ends among them. The chains refer to the new outlines afterwards.
void keep_points(std::vector<PatternPiece>& pieces, std::vector<Chain>& chains,
                 const std::vector<std::vector<Index>>& kept);

/// Takes edges without length out of the outlines.
void drop_empty_edges(std::vector<PatternPiece>& pieces, std::vector<Chain>& chains);

/// Makes the chains with two sides the pattern's seams, numbered from 1 in their order, measures
/// them, and writes to each edge what lies along it.
void set_seams(Pattern& pattern, const std::vector<Chain>& chains);

/// Sets the lengths of all sides, and of the hems.
void measure_sides(Pattern& pattern);

/// A place on a side of a seam.
struct SidePoint {
    Vec2 position = Vec2::Zero(); // mm
    Vec2 outward = Vec2::Zero();  // unit, across the outline, away from the piece
};

/// The place `mm` along a side, from the seam's start, as the notches are given.
SidePoint point_on_side(const std::vector<PatternPiece>& pieces, const SeamSide& side, double mm);

/// Places the notches of every seam at the same shares of the length on both sides, about
/// `spacing_mm` apart and away from the seam's ends, where all corners are. Their distances grow
/// along the seam: it cannot be sewn the other way round without notice. A notch near a sharp bend
/// moves to a straighter place close by, on both sides alike. 0 = no notches.
void set_notches(Pattern& pattern, double spacing_mm);

} // namespace devseg::pattern
