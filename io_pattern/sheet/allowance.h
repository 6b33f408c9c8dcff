// Seam allowance: a piece grown by a width all around, with the corners that sewing wants.
#pragma once

#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg {

/// Convex corners of the cut line: pointed, up to twice the width away from the corner; cut off
/// straight; or rounded. Concave corners are always trimmed to where the two sides meet.
enum class CornerStyle { miter, bevel, round };

/// The cut lines of the piece, outer one first: closed, counterclockwise around the piece and
/// clockwise around its holes. Darts narrower than twice the width are covered, and so are holes.
std::vector<std::vector<Vec2>> add_allowance(const PatternPiece& piece, double width,
                                             CornerStyle corners);

} // namespace devseg
