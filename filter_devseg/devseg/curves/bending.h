// Curves in the plane of a strip, smoothed by bending.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "devseg/curves/strip.h"

namespace devseg::curves {

// A smooth curve in the plane of a strip, sampled at equal distances.
struct SmoothCurve {
    std::vector<Vec2> samples;
    double step = 1.0;

    Vec2 place(double along) const {
        const double k = std::clamp(along / step, 0.0, static_cast<double>(samples.size() - 1));
        const auto i = std::min(static_cast<std::size_t>(k), samples.size() - 2);
        const double s = k - static_cast<double>(i);
        return (1.0 - s) * samples[i] + s * samples[i + 1];
    }
};

/// A place that the curve is to pass: that at `along`, shifted.
struct Hold {
    double along = 0.0;
    Vec2 shift{0.0, 0.0};
};

/// The way through the stops, without waves shorter than `scale`: one of so many rounds, which
/// share the smoothing among them.
SmoothCurve smooth_curve(const std::vector<FlatStop>& stops, const std::vector<Hold>& holds,
                         double scale, int rounds);

/// Where the smooth curve meets the line of an edge, from its right end (0) to its left (1),
/// nearest to where the curve met it before. None where it does not come near.
std::optional<double> meet(const SmoothCurve& curve, const FlatStop& stop);

} // namespace devseg::curves
