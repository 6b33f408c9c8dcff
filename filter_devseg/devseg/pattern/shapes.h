// The shapes of pieces: their sizes, their grain line, and which of them are the same.
#pragma once

#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

/// Long and short side of the least box around the piece, and the direction of the long side.
struct PieceBox {
    double long_side = 0.0;
    double short_side = 0.0;
    Vec2 direction = Vec2::UnitY(); // unit, upwards
};
PieceBox least_box(const std::vector<Vec2>& points);

/// Sets both sides' lengths and the grain line: along the long direction or upwards, through the
/// label's place, and clear of the outlines.
void set_sizes(PatternPiece& piece, GrainDirection grain);

/// Finds pieces of the same shape, straight or mirrored: rigid motions are fitted to points spaced
/// evenly along the outlines, and hold where no outline is farther than `tolerance_mm` (and a
/// hundredth of the piece's size) from the other. Sets model, mirrored and the quantities.
void find_same_pieces(std::vector<PatternPiece>& pieces, double tolerance_mm);

} // namespace devseg::pattern
