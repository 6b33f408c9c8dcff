#include "devseg/flatten/energy/area_balance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/distortion.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/projected_newton.h"

namespace devseg::flatten {

namespace {

constexpr double even = 0.1; // changes below this are left alone: Wang's own bound for LPFB
// The penalty is (z²)³, with z the change over this bound: nothing for changes that are allowed,
// and more than the shear of a usual face for others.
constexpr double bound = 0.12;
constexpr double usual_weight = 0.02;
constexpr double least_share = 0.5; // of the mean area: what a small face counts at least
// Of the boundary where it moves, while areas become even and where the last of them do.
constexpr double stiffness = 5e3;
constexpr double last_stiffness = 5e6;
constexpr int most_steps = 12;
constexpr double sufficient_decrease = 1e-4; // Armijo's constant
constexpr double safe_step = 0.8;            // of the step at which the first face collapses
constexpr double smallest_step = 1e-4;
constexpr double little_gain = 5e-3; // share of the energy's excess that a step must gain
constexpr double uneven = 0.6;       // faces above this share of the bound are moved
constexpr int rings = 6;             // of faces around them, which move as well

// The energy: symmetric Dirichlet, and the penalty on each face's ratio of areas ρ = det J, whose
// least lies in the middle of the ratios that are allowed at both scales.
class BalancedEnergy {
public:
    explicit BalancedEnergy(double whole) {
        const double low = std::max(1.0 - bound, whole / (1.0 + bound));
        const double high = std::min(1.0 + bound, whole * (1.0 + bound));
        center_ = low < high ? 0.5 * (low + high) : whole;
        width_ = std::max(0.5 * (high - low), 0.25 * bound);
    }

    double value(const FlatteningProblem& problem, const Positions& x) const {
        double sum = distortion(problem, x);
        if (!std::isfinite(sum))
            return sum;
        for (std::size_t f = 0; f < problem.faces.size(); ++f) {
            const double z = change(jacobian(problem, x, f).determinant());
            sum += share(problem, f) * weight * z * z * z * z * z * z;
        }
        for_each_boundary_edge(problem, x,
                               [&](Index, Index, const Eigen::RowVector2d& edge, double own) {
                                   const double excess = edge.norm() - own;
                                   sum += boundary_stiffness / problem.total_area * excess * excess;
                               });
        return sum;
    }

    Positions gradient(const FlatteningProblem& problem, const Positions& x) const {
        Positions sum = distortion_gradient(problem, x);
        for (std::size_t f = 0; f < problem.faces.size(); ++f) {
            const Triangle& t = problem.faces[f];
            const double z = change(jacobian(problem, x, f).determinant());
            // ∂ det J / ∂ corner k is the opposite edge, turned by a quarter, over twice the area.
            const double slope = share(problem, f) * weight * 6.0 * z * z * z * z * z /
                                 (width_ * 2.0 * problem.area[f]);
            for (std::size_t k = 0; k < 3; ++k) {
                const Eigen::RowVector2d edge = x.row(t[(k + 2) % 3]) - x.row(t[(k + 1) % 3]);
                sum.row(t[k]) += slope * Eigen::RowVector2d(-edge.y(), edge.x());
            }
        }
        for_each_boundary_edge(
            problem, x, [&](Vertex v, Index u, const Eigen::RowVector2d& edge, double own) {
                const Eigen::RowVector2d pull = 2.0 * boundary_stiffness / problem.total_area *
                                                (edge.norm() - own) * edge.stableNormalized();
                sum.row(u) += pull;
                sum.row(v) -= pull;
            });
        return sum;
    }

    /// Of the penalty on a face, for each unit of its share of the area.
    double curvature(const FlatteningProblem& problem, std::size_t f, double det) const {
        const double z = change(det);
        return share(problem, f) * problem.total_area / problem.area[f] * weight * 30.0 * z * z *
               z * z / (width_ * width_);
    }

    /// In units of what is allowed, from the middle of it.
    double change(double det) const { return (det - center_) / width_; }

    double largest_change(const FlatteningProblem& problem, const Positions& x) const {
        double largest = 0.0;
        for (std::size_t f = 0; f < problem.faces.size(); ++f)
            largest = std::max(largest, std::abs(change(jacobian(problem, x, f).determinant())));
        return largest;
    }

    double weight = usual_weight;    // of the penalty
    double boundary_stiffness = 0.0; // of the boundary edges, where they may move

private:
    template <typename Visit>
    void for_each_boundary_edge(const FlatteningProblem& problem, const Positions& x,
                                Visit visit) const {
        for (std::size_t i = 0; i < problem.boundary.size() && boundary_stiffness > 0.0; ++i) {
            const Vertex v = problem.boundary[i];
            const Index u = problem.boundary[(i + 1) % problem.boundary.size()];
            visit(v, u, x.row(u) - x.row(v), problem.boundary_edge[i]);
        }
    }

    // Of the penalty: a small face must keep its area as well, although it has little of it.
    static double share(const FlatteningProblem& problem, std::size_t f) {
        const double mean = problem.total_area / static_cast<double>(problem.faces.size());
        return std::max(problem.area[f], least_share * mean) / problem.total_area;
    }

    double center_ = 1.0;
    double width_ = 1.0;
};

bool is_even(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    return measure_area_change(problem, uv).largest() <= even;
}

} // namespace

double AreaChange::largest() const {
    return std::max({1.0 - least, most - 1.0, 1.0 - least / whole, most / whole - 1.0,
                     least > 0.0 ? whole / least - 1.0 : infinite});
}

AreaChange measure_area_change(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    AreaChange change;
    change.least = infinite;
    change.most = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const double ratio = jacobian(problem, uv, f).determinant();
        change.least = std::min(change.least, ratio);
        change.most = std::max(change.most, ratio);
    }
    change.whole = map_area(problem, uv) / problem.total_area;
    return change;
}

namespace {

// The faces around those that change most: the border of their part, and the chart's, stay.
PartialProblem region_around_uneven(const FlatteningProblem& whole, const std::vector<Vec2>& uv,
                                    const BalancedEnergy& energy) {
    std::vector<std::uint8_t> inside(uv.size(), 0);
    const auto take = [&](std::size_t f) {
        for (const Vertex v : whole.faces[f])
            inside[v] = 2;
    };
    for (std::size_t f = 0; f < whole.faces.size(); ++f)
        if (std::abs(energy.change(jacobian(whole, uv, f).determinant())) > uneven)
            take(f);
    for (int ring = 0; ring < rings; ++ring) {
        for (std::uint8_t& mark : inside)
            mark = mark != 0 ? 1 : 0;
        for (std::size_t f = 0; f < whole.faces.size(); ++f) {
            const Triangle& t = whole.faces[f];
            if (inside[t[0]] == 1 || inside[t[1]] == 1 || inside[t[2]] == 1)
                for (const Vertex v : t)
                    if (inside[v] == 0)
                        inside[v] = 2;
        }
    }
    for (const Vertex v : whole.boundary)
        inside[v] = 0;
    std::vector<Index> faces;
    for (std::size_t f = 0; f < whole.faces.size(); ++f) {
        const Triangle& t = whole.faces[f];
        if (inside[t[0]] != 0 || inside[t[1]] != 0 || inside[t[2]] != 0)
            faces.push_back(static_cast<Index>(f));
    }
    PartialProblem region = part_of(whole, faces);
    for (std::size_t v = 0; v < region.vertex.size(); ++v)
        region.fixed[v] = inside[region.vertex[v]] == 0 ? 1 : 0;
    return region;
}

void hold(const std::vector<std::uint8_t>& fixed, Positions& rows) {
    for (std::size_t v = 0; v < fixed.size(); ++v)
        if (fixed[v] != 0)
            rows.row(static_cast<Eigen::Index>(v)).setZero();
}

void descend(const PartialProblem& region, const BalancedEnergy& energy, Positions& x,
             const Progress& progress) {
    ProjectedNewton newton(
        region.problem, region.fixed,
        [&](std::size_t f, double det) { return energy.curvature(region.problem, f, det); },
        energy.boundary_stiffness);
    double value = energy.value(region.problem, x);
    for (int i = 0; i < most_steps; ++i) {
        progress.check();
        Positions gradient = energy.gradient(region.problem, x);
        hold(region.fixed, gradient);
        Positions d = newton.direction(x, gradient);
        hold(region.fixed, d);
        const double decrease = (gradient.array() * d.array()).sum();
        const double before = value;
        double step = std::min(1.0, safe_step * collapse_step(region.problem, x, d));
        for (; decrease < 0.0 && step > smallest_step; step *= 0.5) {
            const Positions next = x + step * d;
            const double next_value = energy.value(region.problem, next);
            if (next_value <= value + sufficient_decrease * step * decrease) {
                x = next;
                value = next_value;
                break;
            }
        }
        if (before - value < little_gain * (before - 1.0))
            return;
    }
}

} // namespace

void balance_areas(const FlatteningProblem& problem, std::vector<Vec2>& uv,
                   const Progress& progress) {
    if (is_even(problem, uv))
        return;
    BalancedEnergy energy(map_area(problem, uv) / problem.total_area);
    const PartialProblem region = region_around_uneven(problem, uv, energy);
    if (region.vertex.empty())
        return;
    Positions x(region.problem.vertex_count, 2);
    for (std::size_t v = 0; v < region.vertex.size(); ++v)
        x.row(static_cast<Eigen::Index>(v)) = uv[region.vertex[v]].transpose();
    for (const double strength : {1.0, 30.0}) {
        energy.weight = strength * usual_weight;
        descend(region, energy, x, progress);
        if (energy.largest_change(region.problem, x) <= 1.0)
            break;
    }
    std::vector<Vec2> moved = uv;
    for (std::size_t v = 0; v < region.vertex.size(); ++v)
        moved[region.vertex[v]] = x.row(static_cast<Eigen::Index>(v)).transpose();
    if (measure_area_change(problem, moved).largest() < measure_area_change(problem, uv).largest())
        uv = std::move(moved);
}

std::vector<Vec2> balance_with_boundary(const FlatteningProblem& problem,
                                        const std::vector<Vec2>& uv, const Progress& progress) {
    BalancedEnergy energy(1.0);
    const PartialProblem region{problem, {}, {}};
    Positions x(problem.vertex_count, 2);
    for (std::size_t v = 0; v < uv.size(); ++v)
        x.row(static_cast<Eigen::Index>(v)) = uv[v].transpose();
    for (const double strength : {1.0, 30.0}) {
        energy.weight = strength * usual_weight;
        energy.boundary_stiffness = strength > 1.0 ? last_stiffness : stiffness;
        descend(region, energy, x, progress);
        if (energy.largest_change(problem, x) <= 1.0)
            break;
    }
    std::vector<Vec2> moved;
    for (Eigen::Index v = 0; v < x.rows(); ++v)
        moved.emplace_back(x.row(v).transpose());
    return moved;
}

} // namespace devseg::flatten
