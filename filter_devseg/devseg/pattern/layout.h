// Where the pieces lie on the sheet.
#pragma once

#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// Moves the piece and all that is drawn in it.
void move_piece(PatternPiece& piece, const Vec2& offset);

Eigen::AlignedBox2d bounding_box(const std::vector<PatternPiece>& pieces);

/// Whether a common point lies inside both pieces. Pieces may touch, and lie in each other's holes.
bool overlap(const PatternPiece& a, const PatternPiece& b);

/// The pieces that overlap one before them.
std::vector<std::size_t> overlapping_pieces(const std::vector<PatternPiece>& pieces);

/// Moves these pieces to rows above all others, the highest first. The pieces' boxes must be set.
void shelve(std::vector<PatternPiece>& pieces, std::vector<std::size_t> moved);

} // namespace devseg::pattern
