// What the shape of a piece says: its name's place, its size and its grain.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"
#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

/// Long and short side of the least box around the piece, and the direction of the long side.
struct PieceBox {
    double long_side = 0.0;
    double short_side = 0.0;
    Vec2 direction = Vec2::UnitY(); // unit, upwards
};
PieceBox least_box(const std::vector<Vec2>& points);

/// Sets both sides' lengths, and returns the box.
PieceBox set_sizes(PatternPiece& piece);

/// Sets the grain line: in this direction (unit), through the label's place, and clear of the
/// outlines.
void set_grain(PatternPiece& piece, const Vec2& direction);

struct LabelPoint {
    Vec2 position = Vec2::Zero();
    double radius = 0.0; // distance from the nearest outline, same units; 0 = no inside found
};

/// The pole of inaccessibility of the area that the closed outlines bound by the even-odd rule,
/// within 2 % of its radius. The outer outline comes first. Always inside where there is one,
/// however thin the piece.
LabelPoint find_label_point(const std::vector<std::vector<Vec2>>& outlines);

} // namespace devseg::pattern
