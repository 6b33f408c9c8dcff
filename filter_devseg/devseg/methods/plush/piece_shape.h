// Shapes of flat pieces: where they are narrow.
#pragma once

#include <cstddef>
#include <vector>

#include "devseg/base/numbers.h"

namespace devseg::plush {

/// A narrow place of a piece: what hangs on it, a tongue by its root, a lobe by
/// its stalk, a hook by its bend. A straight line inside the piece, between two
/// corners of its outline.
struct Neck {
    double width = 1.0; // over the root of the smaller area on either side
    std::size_t first = 0;
    std::size_t last = 0;
};

/// The narrowest neck of an outline (a closed polygon, counterclockwise) that
/// is narrower than `limit`; of the width `limit` where there is none. Darts
/// are notches of the outline, and narrow what they leave. A square has none
/// below 0.7, a point of 12 degrees none below 0.65.
Neck narrowest_neck(const std::vector<Vec2>& outline, double limit);

} // namespace devseg::plush
