// Charts in the plane of their texture coordinates as pieces on paper: their outlines are traced,
// and the pieces put on the sheet.
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

} // namespace devseg::pattern
