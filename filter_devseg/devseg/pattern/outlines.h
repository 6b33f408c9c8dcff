// Charts in the plane of their texture coordinates as pieces on paper: large ones are split, their
// outlines traced, and the pieces put on the sheet.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// One piece for each chart, without name and label, where the texture coordinates put it up to a
/// common shift. `uv_areas` are the charts' signed areas: charts with 0 are left out, and negative
/// ones are turned over. A layout that is mirrored for the most part is mirrored as a whole; other
/// mirrored charts keep their place, or go to rows above the layout where they would touch others.
std::vector<PatternPiece> trace_pieces(const Mesh& mesh, const CornerUv& uv,
                                       const atlas::ChartMap& charts,
                                       const std::vector<double>& uv_areas, double mm_per_uv,
                                       Progress& progress);

/// Sets the areas of the outlines and of the piece, and its box.
void measure_outlines(PatternPiece& piece);

/// Moves the piece and all that is drawn in it.
void move_piece(PatternPiece& piece, const Vec2& offset);

Eigen::AlignedBox2d bounding_box(const std::vector<PatternPiece>& pieces);

/// Whether a common point lies inside both pieces. Pieces may touch, and lie in each other's holes.
bool overlap(const PatternPiece& a, const PatternPiece& b);

/// The pieces that overlap one before them.
std::vector<std::size_t> overlapping_pieces(const std::vector<PatternPiece>& pieces);

/// Moves these pieces above all others, the highest first, each to the lowest free place. The
/// pieces' boxes must be set.
void move_above(std::vector<PatternPiece>& pieces, std::vector<std::size_t> moved);

struct SplitCharts {
    atlas::ChartMap charts;
    std::vector<std::uint8_t> cut; // 3 #F: 1 on both sides of the new cuts
    Index too_large = 0;           // charts of one face that are still larger than allowed
};

/// Cuts every chart whose least box is longer than `longest` (units of `uv`) across its long
/// direction, into as few parts as fit, along the shortest line of mesh edges within the stretch
/// that leaves both parts small enough, until none is too large.
SplitCharts split_large_charts(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts,
                               double longest, Progress& progress);

} // namespace devseg::pattern
