#include "devseg/curves/bending.h"

#include <algorithm>
#include <cmath>

namespace devseg::curves {

namespace {

struct Tuning {
    double samples = 5.0;   // of the smooth curve, in one scale
    double stiffness = 0.5; // scales: waves of 2 π of these shrink by a factor of e
    double hold = 20.0;     // how much stronger vertices hold the curve than it resists bending
};
constexpr Tuning tuning;

// Solves (1 + W + b T²) y = x with T = tridiagonal(−1, 2, −1) and W = diagonal(weights), in place;
// the ends have no curvature. By L D Lᵀ of a band of two.
void solve_bending(std::vector<Vec2>& x, const std::vector<double>& weights, double b) {
    const std::size_t n = x.size();
    std::vector<double> d(n);
    std::vector<double> l1(n, 0.0);
    std::vector<double> l2(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const bool at_end = i == 0 || i + 1 == n;
        d[i] = 1.0 + weights[i] + (at_end ? 5.0 : 6.0) * b;
        if (i >= 2) {
            l2[i] = b / d[i - 2];
            d[i] -= l2[i] * l2[i] * d[i - 2];
            x[i] -= l2[i] * x[i - 2];
        }
        if (i >= 1) {
            const double other = i >= 2 ? l2[i] * d[i - 2] * l1[i - 1] : 0.0;
            l1[i] = (-4.0 * b - other) / d[i - 1];
            d[i] -= l1[i] * l1[i] * d[i - 1];
            x[i] -= l1[i] * x[i - 1];
        }
    }
    for (std::size_t i = n; i-- > 0;) {
        x[i] /= d[i];
        if (i + 1 < n)
            x[i] -= l1[i + 1] * x[i + 1];
        if (i + 2 < n)
            x[i] -= l2[i + 2] * x[i + 2];
    }
}

} // namespace

SmoothCurve smooth_curve(const std::vector<FlatStop>& stops, const std::vector<Hold>& holds,
                         double scale, int rounds) {
    SmoothCurve curve;
    const double length = stops.back().along;
    const auto pieces = std::max(2, static_cast<int>(std::ceil(tuning.samples * length / scale)));
    curve.step = length / pieces;
    std::size_t i = 0;
    for (int k = 0; k <= pieces; ++k) {
        const double along = curve.step * k;
        while (i + 2 < stops.size() && stops[i + 1].along < along)
            ++i;
        const double part = stops[i + 1].along - stops[i].along;
        const double s = part > 0.0 ? std::clamp((along - stops[i].along) / part, 0.0, 1.0) : 0.0;
        curve.samples.push_back((1.0 - s) * stops[i].point + s * stops[i + 1].point);
    }
    // Straight lines stay as they are, so the ends can be taken for zero.
    const Vec2 from = curve.samples.front();
    const Vec2 slope = (curve.samples.back() - from) / pieces;
    std::vector<Vec2> inner;
    for (int k = 1; k < pieces; ++k)
        inner.push_back(curve.samples[at(k)] - from - slope * k);
    const double units = scale / curve.step;
    const double bending = std::pow(tuning.stiffness * units, 4.0) / rounds;
    std::vector<double> weights(inner.size(), 0.0);
    for (const Hold& hold : holds) {
        const auto nearest =
            std::clamp<std::ptrdiff_t>(std::llround(hold.along / curve.step), 1, pieces - 1);
        const auto k = static_cast<std::size_t>(nearest - 1);
        if (weights[k] > 0.0)
            continue; // held by a vertex beside
        weights[k] = tuning.hold * (1.0 + 6.0 * bending);
        inner[k] += weights[k] * (inner[k] + hold.shift);
    }
    solve_bending(inner, weights, bending);
    for (int k = 1; k < pieces; ++k)
        curve.samples[at(k)] = inner[at(k - 1)] + from + slope * k;
    return curve;
}

std::optional<double> meet(const SmoothCurve& curve, const FlatStop& stop) {
    const Vec2 edge = stop.left - stop.right;
    const double squared = edge.squaredNorm();
    const auto count = static_cast<std::ptrdiff_t>(curve.samples.size()) - 1;
    const auto middle = std::clamp<std::ptrdiff_t>(
        static_cast<std::ptrdiff_t>(stop.along / curve.step), 0, count - 1);
    const auto reach = static_cast<std::ptrdiff_t>(2.0 * std::sqrt(squared) / curve.step) + 2;
    const auto side = [&](std::ptrdiff_t k) {
        const Vec2 d = curve.samples[static_cast<std::size_t>(k)] - stop.right;
        return edge.x() * d.y() - edge.y() * d.x();
    };
    for (std::ptrdiff_t away = 0; away <= reach; ++away)
        for (const std::ptrdiff_t k : {middle - away, middle + away}) {
            if (k < 0 || k >= count)
                continue;
            const double a = side(k);
            const double b = side(k + 1);
            // From the left of the edge to its right, as the strip goes.
            if (!(a >= 0.0 && b < 0.0))
                continue;
            const double s = a / (a - b);
            const Vec2 p = (1.0 - s) * curve.samples[static_cast<std::size_t>(k)] +
                           s * curve.samples[static_cast<std::size_t>(k + 1)];
            return (p - stop.right).dot(edge) / squared;
        }
    return {};
}

} // namespace devseg::curves
