#include "devseg/flatten/energy/strain.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "devseg/flatten/energy/distortion.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    double most_of_it = 0.99; // share of the area
    // Exponents of the faces that only a hundredth of the area exceeds, and of the worst face: what
    // is more than that would drown the others.
    double exponent = 2.5;
    double worst_exponent = 12.0;
    double least_excess = 1e-4; // of the density over 1: maps that are better are not made steeper
};
constexpr Tuning tuning;

struct Stage {
    double share;     // of the exponents
    double stiffness; // of the boundary's edges, where they may move
    int newton_steps; // at most
    double gain;      // share of the energy's excess that a step must gain
};
constexpr Stage bending[] = {{0.0, 20.0, 8, 0.02}, {0.5, 500.0, 12, 0.01}, {1.0, 1e4, 20, 0.005}};
constexpr Stage inside[] = {{0.5, 0.0, 8, 0.01}, {1.0, 0.0, 12, 0.005}};

double density(const Eigen::Matrix2d& j) {
    const double det = j.determinant();
    return det > 0.0 ? 0.25 * j.squaredNorm() * (1.0 + 1.0 / (det * det)) : infinite;
}

// The least value that is not exceeded on a share of the whole weight.
double quantile(const std::vector<double>& value, const std::vector<double>& weight, double share) {
    std::vector<std::size_t> order(value.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return value[a] < value[b] || (value[a] == value[b] && a < b);
    });
    const double whole = std::accumulate(weight.begin(), weight.end(), 0.0);
    double sum = 0.0;
    for (const std::size_t i : order) {
        sum += weight[i];
        if (sum >= share * whole)
            return value[i];
    }
    return order.empty() ? 0.0 : value[order.back()];
}

// Σ A (exp(s (ψ − 1)) − 1) / s / Σ A, the mean of ψ − 1 for s = 0, and springs along the boundary.
class SteepEnergy {
public:
    explicit SteepEnergy(const FlatteningProblem& problem) : problem_(problem) {}

    void begin(const Stage& stage, const Positions& x) {
        stiffness_ = stage.stiffness;
        std::vector<double> excess;
        for (std::size_t f = 0; f < problem_.faces.size(); ++f)
            excess.push_back(density(jacobian(problem_, x, f)) - 1.0);
        const double most = quantile(excess, problem_.area, tuning.most_of_it);
        const double worst = *std::max_element(excess.begin(), excess.end());
        steepness_ =
            stage.share * std::min(tuning.exponent / std::max(most, tuning.least_excess),
                                   tuning.worst_exponent / std::max(worst, tuning.least_excess));
    }

    double value(const Positions& x) const {
        double sum = 0.0;
        for (std::size_t f = 0; f < problem_.faces.size(); ++f) {
            const double excess = density(jacobian(problem_, x, f)) - 1.0;
            sum += problem_.area[f] *
                   (steepness_ > 0.0 ? std::expm1(steepness_ * excess) / steepness_ : excess);
        }
        for_each_boundary_edge(x, [&](Vertex, Vertex, const Eigen::RowVector2d& edge, double own) {
            const double excess = edge.norm() - own;
            sum += stiffness_ * excess * excess;
        });
        return sum / problem_.total_area;
    }

    Positions gradient(const Positions& x) const {
        Positions sum = Positions::Zero(x.rows(), 2);
        for (std::size_t f = 0; f < problem_.faces.size(); ++f) {
            const Eigen::Matrix2d j = jacobian(problem_, x, f);
            const Eigen::Vector4d stress = density_gradient(j);
            const Eigen::Matrix2d force = (problem_.area[f] * gain(j)) *
                                          Eigen::Map<const Eigen::Matrix2d>(stress.data()) *
                                          problem_.inverse[f].transpose();
            const Triangle& t = problem_.faces[f];
            sum.row(t[1]) += force.col(0).transpose();
            sum.row(t[2]) += force.col(1).transpose();
            sum.row(t[0]) -= (force.col(0) + force.col(1)).transpose();
        }
        for_each_boundary_edge(
            x, [&](Vertex v, Vertex u, const Eigen::RowVector2d& edge, double own) {
                const Eigen::RowVector2d pull =
                    2.0 * stiffness_ * (edge.norm() - own) * edge.stableNormalized();
                sum.row(u) += pull;
                sum.row(v) -= pull;
            });
        return sum / problem_.total_area;
    }

    Eigen::Matrix4d hessian(const Eigen::Matrix2d& j) const {
        const Eigen::Vector4d stress = density_gradient(j);
        return gain(j) * (projected_hessian(j) + steepness_ * stress * stress.transpose());
    }

private:
    double gain(const Eigen::Matrix2d& j) const {
        return std::exp(steepness_ * (density(j) - 1.0));
    }

    template <typename Visit>
    void for_each_boundary_edge(const Positions& x, Visit visit) const {
        for (std::size_t i = 0; i < problem_.boundary.size() && stiffness_ > 0.0; ++i) {
            const Vertex v = problem_.boundary[i];
            const Vertex u = problem_.boundary[(i + 1) % problem_.boundary.size()];
            visit(v, u, x.row(u) - x.row(v), problem_.boundary_edge[i]);
        }
    }

    const FlatteningProblem& problem_;
    double stiffness_ = 0.0;
    double steepness_ = 0.0;
};

class Descent {
public:
    Descent(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed,
            const std::vector<Vec2>& start, double stiffness)
        : problem_(problem), fixed_(std::move(fixed)), energy_(problem), x_(positions_of(start)),
          newton_(
              problem, fixed_,
              [this](std::size_t, const Eigen::Matrix2d& j) { return energy_.hessian(j); },
              stiffness) {}

    void restart(const std::vector<Vec2>& start, const ContactPenalty& contacts) {
        x_ = positions_of(start);
        contacts_ = contacts;
    }

    // Returns the energy.
    double run(const Stage& stage, const Progress& progress) {
        energy_.begin(stage, x_);
        newton_.set_boundary_stiffness(stage.stiffness);
        const auto value_at = [&](const Positions& y) {
            return energy_.value(y) + contacts_.energy(y);
        };
        double value = value_at(x_);
        for (int i = 0; i < stage.newton_steps; ++i) {
            progress.check();
            Positions gradient = energy_.gradient(x_);
            push(gradient);
            hold_fixed(fixed_, gradient);
            Positions d = newton_.direction(x_, gradient);
            hold_fixed(fixed_, d);
            const double before = value;
            line_search(problem_, value_at, d, (gradient.array() * d.array()).sum(), x_, value);
            if (before - value < stage.gain * before)
                break;
        }
        return value;
    }

    std::vector<Vec2> uv() const { return points_of(x_); }

private:
    void push(Positions& gradient) {
        if (contacts_.contacts.empty())
            return;
        contacts_.add_gradient(x_, gradient);
        std::vector<Eigen::Matrix2d> blocks(at(problem_.vertex_count), Eigen::Matrix2d::Zero());
        contacts_.add_diagonal(x_, blocks);
        newton_.set_boundary_blocks(std::move(blocks));
    }

    const FlatteningProblem& problem_;
    const std::vector<std::uint8_t> fixed_;
    SteepEnergy energy_;
    ContactPenalty contacts_;
    Positions x_;
    ProjectedNewton newton_; // finds the order of elimination once for all stages
};

} // namespace

void Strain::take_worse(const Strain& other) {
    mean = std::max(mean, other.mean);
    most_of_it = std::max(most_of_it, other.most_of_it);
    worst = std::max(worst, other.worst);
}

std::vector<double> face_strains(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    std::vector<double> strains;
    strains.reserve(problem.faces.size());
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian(problem, uv, f);
        const double det = j.determinant();
        const double larger = 0.5 * (std::hypot(j(0, 0) + j(1, 1), j(1, 0) - j(0, 1)) +
                                     std::hypot(j(0, 0) - j(1, 1), j(1, 0) + j(0, 1)));
        strains.push_back(det > 0.0 ? std::max(larger / det - 1.0, 1.0 - 1.0 / larger) : infinite);
    }
    return strains;
}

Strain measure_strain(const std::vector<double>& strain, const std::vector<double>& area) {
    Strain result;
    double whole = 0.0;
    for (std::size_t f = 0; f < strain.size(); ++f) {
        result.worst = std::max(result.worst, strain[f]);
        result.mean += strain[f] * area[f];
        whole += area[f];
    }
    result.mean /= whole;
    result.most_of_it = quantile(strain, area, tuning.most_of_it);
    return result;
}

std::vector<Vec2> least_strain(const FlatteningProblem& problem, const std::vector<Vec2>& uv,
                               const Progress& progress) {
    std::vector<std::uint8_t> fixed(uv.size(), 0);
    for (const Vertex v : problem.boundary)
        fixed[v] = 1;
    Descent descent(problem, std::move(fixed), uv, 0.0);
    for (const Stage& stage : inside)
        descent.run(stage, progress);
    return descent.uv();
}

std::vector<Vec2> least_strain_with_boundary(const FlatteningProblem& problem,
                                             const std::vector<Vec2>& uv, double give_up,
                                             const Progress& progress) {
    Descent descent(problem, {}, uv, bending[0].stiffness);
    for (const Stage& stage : bending) {
        const double energy = descent.run(stage, progress);
        if (stage.share == 0.0 && energy > give_up)
            return {};
    }
    return descent.uv();
}

struct BoundaryPush::State {
    Descent descent;
};

BoundaryPush::BoundaryPush(const FlatteningProblem& problem, const std::vector<Vec2>& uv)
    : state_(new State{Descent(problem, {}, uv, std::rbegin(bending)->stiffness)}) {}
BoundaryPush::~BoundaryPush() = default;

std::vector<Vec2> BoundaryPush::run(const std::vector<Vec2>& uv, const ContactPenalty& contacts,
                                    const Progress& progress) {
    state_->descent.restart(uv, contacts);
    state_->descent.run(*std::rbegin(bending), progress);
    return state_->descent.uv();
}

} // namespace devseg::flatten
