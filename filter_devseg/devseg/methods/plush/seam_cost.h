// What a network of seams costs whoever sews it: one number, which every move asks for.
#pragma once

#include <vector>

#include <cstdlib>
#include "devseg/base/numbers.h"

namespace devseg::plush {

inline double tune(const char* n, double d) { const char* v = getenv(n); return v ? atof(v) : d; }
/// Prices, as lengths of seam. What has no unit counts in roots of the model's surface.
struct SeamCost {
    double per_patch = tune("PP", 0.1);   // a patch more to cut out, to turn and to place
    double per_narrow = tune("PN", 6.0);  // each length by which a piece is too narrow somewhere
    double per_corner = tune("PC", 0.1);  // an acute angle between two seams that meet
    double per_failure = tune("PF", 0.3); // a patch that must be cut again
    double wide_enough = tune("WE", 0.7); // a neck's width over the root of the smaller part beyond it
};

/// By how much a piece is too narrow, in the unit of its outline (a closed polygon, counterclockwise):
/// the sum over all parts that hang on it by a neck, a tongue by its root, a lobe by its stalk, a
/// hook by its bend, of what the neck lacks of `wide_enough`. Darts are notches of the outline, and
/// narrow what they leave. Round, square and pointed pieces have none of it.
double narrowness(const std::vector<Vec2>& outline, double wide_enough);

} // namespace devseg::plush
