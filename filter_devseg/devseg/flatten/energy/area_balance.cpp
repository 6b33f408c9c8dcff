#include "devseg/flatten/energy/area_balance.h"

#include <algorithm>
#include <cmath>

#include "devseg/flatten/energy/distortion.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    // The penalty is (z²)³, with z the change over this bound: nothing for changes that are
    // allowed, and more than the shear of a usual face for others.
    double penalised_change = 1.2 * usual_area_change;
    double small_face = 0.5; // of the mean area: what a small face counts at least
    int newton_steps = 12;
    double excess_gain = 5e-3; // share of the energy's excess that a step must gain
    double uneven = 0.6;       // faces above this share of the bound are moved
    int moved_rings = 6;       // of faces around them, which move as well
};
constexpr Tuning tuning;

// Of the penalty, and of the boundary where it moves: while areas become even, and where the last
// of them do.
struct Stage {
    double weight;
    double stiffness;
};
constexpr Stage stages[] = {{0.02, 5e3}, {0.6, 5e6}};

// The energy: symmetric Dirichlet, and the penalty on each face's ratio of areas ρ = det J, whose
// least lies in the middle of the ratios that are allowed at both scales.
class BalancedEnergy {
public:
    explicit BalancedEnergy(double whole) {
        const double low =
            std::max(1.0 - tuning.penalised_change, whole / (1.0 + tuning.penalised_change));
        const double high =
            std::min(1.0 + tuning.penalised_change, whole * (1.0 + tuning.penalised_change));
        center_ = low < high ? 0.5 * (low + high) : whole;
        width_ = std::max(0.5 * (high - low), 0.25 * tuning.penalised_change);
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

    double weight = 0.0;             // of the penalty
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
        return std::max(problem.area[f], tuning.small_face * mean) / problem.total_area;
    }

    double center_ = 1.0;
    double width_ = 1.0;
};

// The faces around those that change most: the border of their part, and the chart's, stay.
PartialProblem region_around_uneven(const FlatteningProblem& whole, const std::vector<Vec2>& uv,
                                    const BalancedEnergy& energy) {
    std::vector<std::uint8_t> inside(uv.size(), 0);
    const auto take = [&](std::size_t f) {
        for (const Vertex v : whole.faces[f])
            inside[v] = 2;
    };
    for (std::size_t f = 0; f < whole.faces.size(); ++f)
        if (std::abs(energy.change(jacobian(whole, uv, f).determinant())) > tuning.uneven)
            take(f);
    for (int ring = 0; ring < tuning.moved_rings; ++ring) {
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

void descend(const PartialProblem& region, const BalancedEnergy& energy, Positions& x,
             const Progress& progress) {
    ProjectedNewton newton(
        region.problem, region.fixed,
        [&](std::size_t f, const Eigen::Matrix2d& j) -> Eigen::Matrix4d {
            const Eigen::Vector4d cofactor(j(1, 1), -j(0, 1), -j(1, 0), j(0, 0)); // ∂ det / ∂ J
            return projected_hessian(j) + energy.curvature(region.problem, f, j.determinant()) *
                                              cofactor * cofactor.transpose();
        },
        energy.boundary_stiffness);
    const auto value_at = [&](const Positions& y) { return energy.value(region.problem, y); };
    double value = value_at(x);
    for (int i = 0; i < tuning.newton_steps; ++i) {
        progress.check();
        Positions gradient = energy.gradient(region.problem, x);
        hold_fixed(region.fixed, gradient);
        Positions d = newton.direction(x, gradient);
        hold_fixed(region.fixed, d);
        const double before = value;
        line_search(region.problem, value_at, d, (gradient.array() * d.array()).sum(), x, value);
        if (before - value < tuning.excess_gain * (before - 1.0))
            return;
    }
}

// All stages, until no change of a face's area is above the bound.
Positions balance(const PartialProblem& region, const std::vector<Vec2>& start, bool holds_boundary,
                  BalancedEnergy& energy, const Progress& progress) {
    Positions x = positions_of(start);
    for (const Stage& stage : stages) {
        energy.weight = stage.weight;
        energy.boundary_stiffness = holds_boundary ? 0.0 : stage.stiffness;
        descend(region, energy, x, progress);
        if (energy.largest_change(region.problem, x) <= 1.0)
            break;
    }
    return x;
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

void balance_areas(const FlatteningProblem& problem, std::vector<Vec2>& uv,
                   const Progress& progress) {
    if (measure_area_change(problem, uv).largest() <= usual_area_change)
        return;
    BalancedEnergy energy(map_area(problem, uv) / problem.total_area);
    const PartialProblem region = region_around_uneven(problem, uv, energy);
    if (region.vertex.empty())
        return;
    std::vector<Vec2> start;
    for (const Vertex v : region.vertex)
        start.push_back(uv[v]);
    const Positions x = balance(region, start, true, energy, progress);
    std::vector<Vec2> moved = uv;
    for (std::size_t v = 0; v < region.vertex.size(); ++v)
        moved[region.vertex[v]] = x.row(static_cast<Eigen::Index>(v)).transpose();
    if (measure_area_change(problem, moved).largest() < measure_area_change(problem, uv).largest())
        uv = std::move(moved);
}

std::vector<Vec2> balance_with_boundary(const FlatteningProblem& problem,
                                        const std::vector<Vec2>& uv, const Progress& progress) {
    BalancedEnergy energy(1.0);
    return points_of(balance({problem, {}, {}}, uv, false, energy, progress));
}

} // namespace devseg::flatten
