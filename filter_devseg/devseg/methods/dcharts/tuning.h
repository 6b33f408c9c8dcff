// The numbers of D-Charts, and why they have these values.
#pragma once

#include "devseg/mesh/mesh.h"

namespace devseg::dcharts {

struct Tuning {
    // Growth

    // [JKS05] stops when fewer faces than this change their chart between two rounds.
    double converged_share = 0.05;
    // [JKS05] looks at the k faces with the smallest fitting error for the next seed.
    Index seed_candidates = 10;
    // On planes and cylinders F is 0 and the product cost would ignore compactness. The floor is
    // the error of a normal that leans 1 degree against a cylinder's: less is within the noise of
    // meshes.
    double fitting_error_floor = 3e-4;
    // A hole below this share of the average chart's area is filled by its neighbours; a larger one
    // gets charts of its own [JKS05, section 3.2, which gives no number].
    double small_hole_share = 0.25;

    // Joins, splits and darts

    // Stretch that equal lengths of border are worth when two joins cost next to nothing: a share
    // of the area for each √area of border.
    double negligible = 1e-5;
    double small_allowance = 3.0; // of small charts, over the bounds of others
    double least_part = 0.05;     // of a chart: smaller parts are not worth a chart
    std::size_t tried_spots = 3;  // of a chart, for each dart
    double worst_spot_gain = 0.1; // share of the excess over the bound that a dart must take
};
inline constexpr Tuning tuning;

} // namespace devseg::dcharts
