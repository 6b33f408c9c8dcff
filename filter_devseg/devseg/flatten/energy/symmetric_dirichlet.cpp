// References
//   J. Smith, S. Schaefer: Bijective Parameterization with Free Boundaries. ACM Transactions on
//   Graphics 34(4), 2015. doi:10.1145/2766947 (the energy; the step bound of section 3.3)
//   T. Liu, S. Bouaziz, L. Kavan: Quasi-Newton Methods for Real-Time Simulation of Hyperelastic
//   Materials. ACM Transactions on Graphics 36(3), 2017. doi:10.1145/2990496 (L-BFGS that starts
//   from the Laplacian: one factorization serves all steps)
#include "devseg/flatten/energy/symmetric_dirichlet.h"

#include <algorithm>
#include <deque>

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/distortion.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/projected_newton.h"

namespace devseg::flatten {

namespace {

constexpr std::size_t history = 6;           // pairs that L-BFGS remembers
constexpr double sufficient_decrease = 1e-4; // Armijo's constant
constexpr double safe_step = 0.8; // share of the step at which the first triangle collapses
constexpr double smallest_step = 1e-12;
constexpr int stall_window = 10;      // steps over which progress is judged
constexpr double locked = 1e20;       // stiffness of vertices that stay: their steps vanish
constexpr double near_isometry = 1.2; // energy below which one factorization is enough
constexpr double little_gain = 1e-3;  // share of the energy that a Newton step must gain
constexpr double steps_to_come = 4.0; // gains like the last one that a descent may still hope for

// The cotangent Laplacian of the rest shape, made definite by a shift far below its own size: the
// energy's Hessian at an isometry, up to a factor and the rotations.
class Preconditioner {
public:
    Preconditioner(const FlatteningProblem& problem, const std::vector<std::uint8_t>& fixed) {
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(12 * problem.faces.size());
        const double scale = 0.5 / problem.total_area;
        for (std::size_t f = 0; f < problem.faces.size(); ++f)
            for (Index k = 0; k < 3; ++k) {
                const Index i = problem.faces[f][k];
                const Index j = problem.faces[f][(k + 1) % 3];
                const double w = scale * problem.cotangent[f][k];
                entries.emplace_back(i, i, w);
                entries.emplace_back(j, j, w);
                entries.emplace_back(i, j, -w);
                entries.emplace_back(j, i, -w);
            }
        double shift = 1e-8 / problem.total_area;
        for (Vertex v = 0; v < problem.vertex_count; ++v)
            entries.emplace_back(v, v, fixed.empty() || fixed[v] == 0 ? shift : locked);
        Eigen::SparseMatrix<double> matrix(problem.vertex_count, problem.vertex_count);
        matrix.setFromTriplets(entries.begin(), entries.end());
        solver_.compute(matrix);
        // The cotangents of needles swallow the shift.
        for (; solver_.info() != Eigen::Success && shift < locked; shift *= 1e3) {
            matrix.diagonal().array() += shift;
            solver_.factorize(matrix);
        }
        if (solver_.info() != Eigen::Success)
            throw NumericalFailure("expected a positive definite Laplacian, found a singular one");
    }

    // Eigen reads the factor anew for each column; here it is read once for both.
    Positions solve(const Positions& rhs) const {
        const Eigen::SparseMatrix<double>& lower = solver_.matrixL().nestedExpression();
        const Index* begin = lower.outerIndexPtr();
        const Index* row = lower.innerIndexPtr();
        const double* value = lower.valuePtr();
        Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> x = solver_.permutationP() * rhs;
        for (Eigen::Index j = 0; j < x.rows(); ++j) {
            const Eigen::RowVector2d known = x.row(j);
            for (Index k = begin[j]; k < begin[j + 1]; ++k)
                x.row(row[k]) -= value[k] * known;
        }
        x.array().colwise() /= solver_.vectorD().array();
        for (Eigen::Index j = x.rows(); j-- > 0;) {
            Eigen::RowVector2d sum = x.row(j);
            for (Index k = begin[j]; k < begin[j + 1]; ++k)
                sum -= value[k] * x.row(row[k]);
            x.row(j) = sum;
        }
        return solver_.permutationPinv() * x;
    }

private:
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

double dot(const Positions& a, const Positions& b) {
    return (a.array() * b.array()).sum();
}

// Limited-memory BFGS with the preconditioner as initial inverse Hessian.
class QuasiNewton {
public:
    QuasiNewton(const FlatteningProblem& problem, const std::vector<std::uint8_t>& fixed)
        : preconditioner_(problem, fixed) {}

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

// A descent: the current map, its energy and gradient, penalty included.
class Descent {
public:
    Descent(const FlatteningProblem& problem, const std::vector<std::uint8_t>& fixed,
            const ContactPenalty& penalty, Positions start)
        : problem_(problem), fixed_(fixed), penalty_(penalty), x_(std::move(start)),
          energy_(value(x_)), gradient_(slope(x_)) {}

    const Positions& x() const { return x_; }
    double energy() const { return energy_; }
    const Positions& gradient() const { return gradient_; }

    /// Goes along a descent direction as far as pays; false if there is no such step.
    bool advance(Positions d) {
        hold_fixed(d);
        const double decrease = dot(gradient_, d);
        if (!(decrease < 0.0))
            return false;
        double step = std::min(1.0, safe_step * collapse_step(problem_, x_, d));
        for (; step > smallest_step; step *= 0.5) {
            Positions next = x_ + step * d;
            const double next_energy = value(next);
            if (next_energy > energy_ + sufficient_decrease * step * decrease)
                continue;
            if (!(next_energy < energy_))
                return false;
            Positions next_gradient = slope(next);
            step_ = next - x_;
            change_ = next_gradient - gradient_;
            x_ = std::move(next);
            gradient_ = std::move(next_gradient);
            energy_ = next_energy;
            return true;
        }
        return false;
    }
    const Positions& last_step() const { return step_; }
    const Positions& last_change() const { return change_; } // of the gradient

private:
    double value(const Positions& y) const { return distortion(problem_, y) + penalty_.energy(y); }
    Positions slope(const Positions& y) const {
        Positions g = distortion_gradient(problem_, y);
        penalty_.add_gradient(y, g);
        hold_fixed(g);
        return g;
    }
    void hold_fixed(Positions& rows) const {
        for (std::size_t v = 0; v < fixed_.size(); ++v)
            if (fixed_[v] != 0)
                rows.row(static_cast<Eigen::Index>(v)).setZero();
    }

    const FlatteningProblem& problem_;
    const std::vector<std::uint8_t>& fixed_;
    const ContactPenalty& penalty_;
    Positions x_;
    double energy_;
    Positions gradient_;
    Positions step_;
    Positions change_;
};

bool is_hopeless(double energy, double last_gain, const SymmetricDirichletOptions& options) {
    return energy - steps_to_come * last_gain > options.give_up_energy;
}

// Newton's method until the map is near enough to an isometry for the Laplacian to be a good model
// of the Hessian, or until it gains little.
void approach(const FlatteningProblem& problem, const SymmetricDirichletOptions& options,
              const Progress& progress, Descent& descent, SymmetricDirichletResult& result) {
    if (descent.energy() < near_isometry)
        return;
    ProjectedNewton newton(problem, options.fixed);
    while (result.iterations < options.max_iterations && descent.energy() > near_isometry) {
        progress.check();
        const double before = descent.energy();
        if (!descent.advance(newton.direction(descent.x(), descent.gradient())))
            return;
        ++result.iterations;
        const double gain = before - descent.energy();
        if (gain < little_gain * before || is_hopeless(descent.energy(), gain, options))
            return;
    }
}

void polish(const FlatteningProblem& problem, const SymmetricDirichletOptions& options,
            const Progress& progress, Descent& descent, SymmetricDirichletResult& result) {
    QuasiNewton model(problem, options.fixed);
    std::deque<double> recent{descent.energy()};
    while (result.iterations < options.max_iterations && !result.converged) {
        progress.check();
        const double before = descent.energy();
        if (!descent.advance(model.direction(descent.gradient()))) {
            result.converged = model.empty(); // then not even the plain gradient leads down
            model.forget();
            continue;
        }
        model.remember(descent.last_step(), descent.last_change());
        ++result.iterations;
        if (is_hopeless(descent.energy(), before - descent.energy(), options))
            return;
        recent.push_back(descent.energy());
        if (recent.size() > stall_window) {
            result.converged =
                recent.front() - descent.energy() < options.relative_tolerance * descent.energy();
            recent.pop_front();
        }
    }
}

} // namespace

SymmetricDirichletResult minimise_symmetric_dirichlet(const FlatteningProblem& problem,
                                                      const std::vector<Vec2>& start,
                                                      const SymmetricDirichletOptions& options,
                                                      const Progress& progress,
                                                      const ContactPenalty& penalty) {
    if (count_flips(problem, start) > 0)
        throw NumericalFailure("expected a start without flipped faces");
    Positions x(problem.vertex_count, 2);
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        x.row(v) = start[v].transpose();

    SymmetricDirichletResult result;
    Descent descent(problem, options.fixed, penalty, std::move(x));
    approach(problem, options, progress, descent, result);
    polish(problem, options, progress, descent, result);
    result.energy = distortion(problem, descent.x());
    result.uv.resize(at(problem.vertex_count));
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        result.uv[v] = descent.x().row(v).transpose();
    return result;
}

double symmetric_dirichlet_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    Positions x(problem.vertex_count, 2);
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        x.row(v) = uv[v].transpose();
    return distortion(problem, x);
}

} // namespace devseg::flatten
