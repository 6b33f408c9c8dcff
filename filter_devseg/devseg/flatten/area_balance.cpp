#include "devseg/flatten/area_balance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/errors.h"
#include "devseg/flatten/distortion.h"
#include "devseg/flatten/map_tools.h"
#include "devseg/flatten/projected_newton.h"

namespace devseg {

namespace {

constexpr double even = 0.1; // changes below this are left alone: Wang's own bound for LPFB
// The penalty is (z²)³, with z the change over this bound: nothing for changes that are allowed,
// and more than the shear of a usual face for others.
constexpr double bound = 0.12;
constexpr double weight = 0.02;
constexpr int most_steps = 20;
constexpr double sufficient_decrease = 1e-4; // Armijo's constant
constexpr double safe_step = 0.8;            // of the step at which the first face collapses
constexpr double smallest_step = 1e-4;
constexpr double little_gain = 2e-3; // share of the energy's excess that a step must gain

// The energy: symmetric Dirichlet, and the penalty on each face's ratio of areas ρ = det J, whose
// least lies in the middle of the ratios that are allowed at both scales.
class BalancedEnergy {
public:
    BalancedEnergy(const FlatteningProblem& problem, double whole) : problem_(problem) {
        const double low = std::max(1.0 - bound, whole / (1.0 + bound));
        const double high = std::min(1.0 + bound, whole * (1.0 + bound));
        center_ = low < high ? 0.5 * (low + high) : whole;
        width_ = std::max(0.5 * (high - low), 0.25 * bound);
    }

    double value(const Positions& x) const {
        double sum = distortion(problem_, x);
        if (!std::isfinite(sum))
            return sum;
        for (std::size_t f = 0; f < problem_.faces.size(); ++f) {
            const double z = change(jacobian(problem_, x, f).determinant());
            sum += share(f) * weight * z * z * z * z * z * z;
        }
        return sum;
    }

    Positions gradient(const Positions& x) const {
        Positions sum = distortion_gradient(problem_, x);
        for (std::size_t f = 0; f < problem_.faces.size(); ++f) {
            const Triangle& t = problem_.faces[f];
            const double z = change(jacobian(problem_, x, f).determinant());
            // ∂ det J / ∂ corner k is the opposite edge, turned by a quarter, over twice the area.
            const double slope =
                share(f) * weight * 6.0 * z * z * z * z * z / width_ / (2.0 * problem_.area[f]);
            for (std::size_t k = 0; k < 3; ++k) {
                const Eigen::RowVector2d edge = x.row(t[(k + 2) % 3]) - x.row(t[(k + 1) % 3]);
                sum.row(t[k]) += slope * Eigen::RowVector2d(-edge.y(), edge.x());
            }
        }
        return sum;
    }

    double curvature(double det) const {
        const double z = change(det);
        return weight * 30.0 * z * z * z * z / (width_ * width_);
    }

private:
    double change(double det) const { return (det - center_) / width_; }
    double share(std::size_t f) const { return problem_.area[f] / problem_.total_area; }

    const FlatteningProblem& problem_;
    double center_ = 1.0;
    double width_ = 1.0;
};

bool is_even(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    return measure_area_change(problem, uv).largest() <= even;
}

std::vector<Vec2> to_points(const Positions& x) {
    std::vector<Vec2> uv(static_cast<std::size_t>(x.rows()));
    for (std::size_t v = 0; v < uv.size(); ++v)
        uv[v] = x.row(static_cast<Eigen::Index>(v)).transpose();
    return uv;
}

} // namespace

double AreaChange::largest() const {
    return std::max({1.0 - least, most - 1.0, 1.0 - least / whole, most / whole - 1.0,
                     least > 0.0 ? whole / least - 1.0 : std::numeric_limits<double>::infinity()});
}

AreaChange measure_area_change(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    AreaChange change;
    change.least = std::numeric_limits<double>::infinity();
    change.most = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const double ratio = jacobian(problem, uv, f).determinant();
        change.least = std::min(change.least, ratio);
        change.most = std::max(change.most, ratio);
    }
    change.whole = map_area(problem, uv) / problem.total_area;
    return change;
}

void balance_areas(const FlatteningProblem& problem, std::vector<Vec2>& uv,
                   const Progress& progress) {
    if (problem.vertex_count == static_cast<Index>(problem.boundary.size()) || is_even(problem, uv))
        return;
    const BalancedEnergy energy(problem, map_area(problem, uv) / problem.total_area);
    std::vector<std::uint8_t> fixed(uv.size(), 0);
    for (const Index v : problem.boundary)
        fixed[at(v)] = 1;
    ProjectedNewton newton(problem, fixed,
                           [&](double det) { return energy.curvature(det); });
    Positions x(problem.vertex_count, 2);
    for (Index v = 0; v < problem.vertex_count; ++v)
        x.row(v) = uv[at(v)].transpose();
    double value = energy.value(x);
    for (int i = 0; i < most_steps; ++i) {
        progress.check();
        Positions gradient = energy.gradient(x);
        for (const Index v : problem.boundary)
            gradient.row(v).setZero();
        Positions d = newton.direction(x, gradient);
        for (const Index v : problem.boundary)
            d.row(v).setZero();
        const double decrease = (gradient.array() * d.array()).sum();
        const double before = value;
        double step = std::min(1.0, safe_step * collapse_step(problem, x, d));
        for (; decrease < 0.0 && step > smallest_step; step *= 0.5) {
            const Positions next = x + step * d;
            const double next_value = energy.value(next);
            if (next_value <= value + sufficient_decrease * step * decrease) {
                x = next;
                value = next_value;
                break;
            }
        }
        if (before - value < little_gain * (before - 1.0))
            break;
    }
    std::vector<Vec2> moved = to_points(x);
    if (measure_area_change(problem, moved).largest() <
        measure_area_change(problem, uv).largest())
        uv = std::move(moved);
}

} // namespace devseg
