// References
//   J. Smith, S. Schaefer: Bijective Parameterization with Free Boundaries. ACM Transactions on
//   Graphics 34(4), 2015. doi:10.1145/2766947 (the energy; the step bound of section 3.3)
//   T. Liu, S. Bouaziz, L. Kavan: Quasi-Newton Methods for Real-Time Simulation of Hyperelastic
//   Materials. ACM Transactions on Graphics 36(3), 2017. doi:10.1145/2990496 (L-BFGS that starts
//   from the Laplacian: one factorization serves all steps)
#include "devseg/flatten/symmetric_dirichlet.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include <Eigen/SparseCholesky>

#include "devseg/errors.h"
#include "devseg/flatten/map_tools.h"

namespace devseg {

namespace {

using Positions = Eigen::MatrixX2d; // #v by 2

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t history = 6;          // pairs that L-BFGS remembers
constexpr double sufficient_decrease = 1e-4; // Armijo's constant
constexpr double safe_step = 0.8;  // share of the step at which the first triangle collapses
constexpr double smallest_step = 1e-12;
constexpr int stall_window = 10; // steps over which progress is judged

Eigen::Matrix2d jacobian_of(const FlatteningProblem& problem, const Positions& x, std::size_t f) {
    const Triangle& t = problem.faces[f];
    Eigen::Matrix2d edges;
    edges.col(0) = (x.row(t[1]) - x.row(t[0])).transpose();
    edges.col(1) = (x.row(t[2]) - x.row(t[0])).transpose();
    return edges * problem.inverse[f];
}

double energy_of(const FlatteningProblem& problem, const Positions& x) {
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian_of(problem, x, f);
        const double det = j.determinant();
        if (!(det > 0.0))
            return infinity;
        // |J⁻¹|² = |J|² / det² in the plane.
        sum += problem.area[f] * j.squaredNorm() * (1.0 + 1.0 / (det * det));
    }
    return sum / (4.0 * problem.total_area);
}

Positions gradient_of(const FlatteningProblem& problem, const Positions& x) {
    Positions gradient = Positions::Zero(x.rows(), 2);
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian_of(problem, x, f);
        const double det = j.determinant();
        Eigen::Matrix2d cofactor; // ∂ det / ∂ J
        cofactor << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);
        const Eigen::Matrix2d stress = (1.0 + 1.0 / (det * det)) * j -
                                       (j.squaredNorm() / (det * det * det)) * cofactor;
        const Eigen::Matrix2d force = (problem.area[f] / (2.0 * problem.total_area)) * stress *
                                      problem.inverse[f].transpose();
        const Triangle& t = problem.faces[f];
        gradient.row(t[1]) += force.col(0).transpose();
        gradient.row(t[2]) += force.col(1).transpose();
        gradient.row(t[0]) -= (force.col(0) + force.col(1)).transpose();
    }
    return gradient;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Smallest t > 0 with a t² + b t + c = 0; infinity if there is none. c > 0.
double first_root(double a, double b, double c) {
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0)
        return infinity;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    double best = infinity;
    for (const double root : {a != 0.0 ? q / a : infinity, q != 0.0 ? c / q : infinity})
        if (root > 0.0)
            best = std::min(best, root);
    return best;
}

// The step along the direction at which the first triangle has no area left.
double collapse_step(const FlatteningProblem& problem, const Positions& x, const Positions& d) {
    double step = infinity;
    for (const Triangle& t : problem.faces) {
        const Eigen::Vector2d p = (x.row(t[1]) - x.row(t[0])).transpose();
        const Eigen::Vector2d q = (x.row(t[2]) - x.row(t[0])).transpose();
        const Eigen::Vector2d dp = (d.row(t[1]) - d.row(t[0])).transpose();
        const Eigen::Vector2d dq = (d.row(t[2]) - d.row(t[0])).transpose();
        step = std::min(step, first_root(cross(dp, dq), cross(p, dq) + cross(dp, q), cross(p, q)));
    }
    return step;
}

// The cotangent Laplacian of the rest shape, made definite by a shift far below its own size: the
// energy's Hessian at an isometry, up to a factor and the rotations.
class Preconditioner {
public:
    explicit Preconditioner(const FlatteningProblem& problem) {
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(12 * problem.faces.size());
        const double scale = 0.5 / problem.total_area;
        for (std::size_t f = 0; f < problem.faces.size(); ++f)
            for (Index k = 0; k < 3; ++k) {
                const Index i = problem.faces[f][at(k)];
                const Index j = problem.faces[f][at((k + 1) % 3)];
                const double w = scale * problem.cotangent[f][at(k)];
                entries.emplace_back(i, i, w);
                entries.emplace_back(j, j, w);
                entries.emplace_back(i, j, -w);
                entries.emplace_back(j, i, -w);
            }
        const double shift = 1e-8 / problem.total_area;
        for (Index v = 0; v < problem.vertex_count; ++v)
            entries.emplace_back(v, v, shift);
        Eigen::SparseMatrix<double> matrix(problem.vertex_count, problem.vertex_count);
        matrix.setFromTriplets(entries.begin(), entries.end());
        solver_.compute(matrix);
        if (solver_.info() != Eigen::Success)
            throw NumericalFailure("expected a positive definite Laplacian, found a singular one");
    }
    Positions solve(const Positions& rhs) const { return solver_.solve(rhs); }

private:
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

double dot(const Positions& a, const Positions& b) {
    return (a.array() * b.array()).sum();
}

// Limited-memory BFGS with the preconditioner as initial inverse Hessian.
class QuasiNewton {
public:
    explicit QuasiNewton(const FlatteningProblem& problem) : preconditioner_(problem) {}

    Positions direction(const Positions& gradient) const {
        Positions q = gradient;
        std::vector<double> alpha(pairs_.size());
        for (std::size_t i = pairs_.size(); i-- > 0;) {
            alpha[i] = dot(pairs_[i].step, q) / pairs_[i].curvature;
            q -= alpha[i] * pairs_[i].change;
        }
        q = preconditioner_.solve(q);
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            const double beta = dot(pairs_[i].change, q) / pairs_[i].curvature;
            q += (alpha[i] - beta) * pairs_[i].step;
        }
        return -q;
    }
    void remember(const Positions& step, const Positions& change) {
        const double curvature = dot(step, change);
        if (!(curvature > 0.0))
            return; // the energy is not convex here: the pair would spoil the model
        if (pairs_.size() == history)
            pairs_.pop_front();
        pairs_.push_back({step, change, curvature});
    }
    void forget() { pairs_.clear(); }
    bool empty() const { return pairs_.empty(); }

private:
    struct Pair {
        Positions step;
        Positions change;
        double curvature;
    };
    Preconditioner preconditioner_;
    std::deque<Pair> pairs_;
};

} // namespace

SymmetricDirichletResult minimise_symmetric_dirichlet(const FlatteningProblem& problem,
                                                      const std::vector<Vec2>& start,
                                                      const SymmetricDirichletOptions& options,
                                                      const Progress& progress,
                                                      const ContactPenalty& penalty) {
    if (count_flips(problem, start) > 0)
        throw NumericalFailure("expected a start without flipped faces");
    Positions x(problem.vertex_count, 2);
    for (Index v = 0; v < problem.vertex_count; ++v)
        x.row(v) = start[at(v)].transpose();

    SymmetricDirichletResult result;
    QuasiNewton model(problem);
    const auto value = [&](const Positions& y) {
        return energy_of(problem, y) + penalty.energy(y);
    };
    const auto slope_of = [&](const Positions& y) {
        Positions g = gradient_of(problem, y);
        penalty.add_gradient(y, g);
        return g;
    };
    double energy = value(x);
    Positions gradient = slope_of(x);
    std::deque<double> recent{energy};
    while (result.iterations < options.max_iterations && !result.converged) {
        progress.check();
        Positions d = model.direction(gradient);
        double slope = dot(gradient, d);
        if (!(slope < 0.0)) {
            model.forget();
            d = model.direction(gradient);
            slope = dot(gradient, d);
        }
        double step = std::min(1.0, safe_step * collapse_step(problem, x, d));
        double next_energy = infinity;
        Positions next;
        while (step > smallest_step) {
            next = x + step * d;
            next_energy = value(next);
            if (next_energy <= energy + sufficient_decrease * step * slope)
                break;
            step *= 0.5;
        }
        if (!(next_energy < energy)) {
            if (model.empty()) {
                result.converged = true; // no descent along the preconditioned gradient is left
                break;
            }
            model.forget();
            continue;
        }
        const Positions next_gradient = slope_of(next);
        model.remember(next - x, next_gradient - gradient);
        x = next;
        gradient = next_gradient;
        energy = next_energy;
        ++result.iterations;
        recent.push_back(energy);
        if (recent.size() > stall_window) {
            result.converged = recent.front() - energy < options.relative_tolerance * energy;
            recent.pop_front();
        }
    }
    result.energy = energy_of(problem, x);
    result.uv.resize(at(problem.vertex_count));
    for (Index v = 0; v < problem.vertex_count; ++v)
        result.uv[at(v)] = x.row(v).transpose();
    return result;
}

double symmetric_dirichlet_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    Positions x(problem.vertex_count, 2);
    for (Index v = 0; v < problem.vertex_count; ++v)
        x.row(v) = uv[at(v)].transpose();
    return energy_of(problem, x);
}

} // namespace devseg
