// What a network of seams costs whoever sews it: one number, which every move asks for.
#pragma once

#include <vector>

#include "devseg/base/numbers.h"

namespace devseg::plush {

/// Prices, as lengths of seam. What has no unit counts in roots of the model's surface.
struct SeamCost {
    double per_patch = 0.1;    // a patch more to cut out, to turn and to place
    double per_narrow = 4.0;   // each length by which a piece is too narrow somewhere
    double per_corner = 0.1;   // an acute angle between two seams that meet
    double per_failure = 0.3;  // a patch that must be cut again
    double wide_enough = 0.65; // a neck's width over the root of the smaller part beyond it
};

/// A narrow place of a piece: what hangs on it by less than it should, a tongue by its root, a lobe
/// by its stalk, a hook by its bend. Between two corners of the outline.
struct Neck {
    double lacking = 0.0; // width, in the unit of the outline
    std::size_t first = 0;
    std::size_t last = 0;
};

/// The necks of an outline (a closed polygon, counterclockwise), those that lack most first, and no
/// other one beyond each: where a straight line inside the piece is shorter than `wide_enough`
/// times the root of the smaller area on either side. Darts are notches of the outline, and narrow
/// what they leave. Round and square pieces, and points of more than 12 degrees, have none.
std::vector<Neck> find_necks(const std::vector<Vec2>& outline, double wide_enough);

/// What they lack together.
double narrowness(const std::vector<Vec2>& outline, double wide_enough);

} // namespace devseg::plush
