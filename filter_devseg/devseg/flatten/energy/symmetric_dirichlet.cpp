// References
//   J. Smith, S. Schaefer: Bijective Parameterization with Free Boundaries. ACM Transactions on
//   Graphics 34(4), 2015. doi:10.1145/2766947 (the energy; the step bound of section 3.3)
//   T. Liu, S. Bouaziz, L. Kavan: Quasi-Newton Methods for Real-Time Simulation of Hyperelastic
//   Materials. ACM Transactions on Graphics 36(3), 2017. doi:10.1145/2990496 (L-BFGS that starts
//   from the Laplacian: one factorization serves all steps)
#include "devseg/flatten/energy/symmetric_dirichlet.h"

#include <algorithm>
#include <deque>
#include <optional>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/laplacian.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    std::size_t history = 6;       // pairs that L-BFGS remembers
    std::size_t stall_window = 10; // steps over which progress is judged
    double near_isometry = 1.2;    // energy below which one factorization is enough
    double newton_gain = 1e-3;     // share of the energy that a Newton step must gain
};
constexpr Tuning tuning;

constexpr double isometry = 1.0; // its energy, which no map is below

double dot(const Positions& a, const Positions& b) {
    return (a.array() * b.array()).sum();
}

// Limited-memory BFGS; the initial Hessian is the Laplacian.
class QuasiNewton {
public:
    explicit QuasiNewton(const Laplacian& laplacian) : laplacian_(laplacian) {}

    Positions direction(const Positions& gradient) const {
        Positions q = gradient;
        std::vector<double> alpha(pairs_.size());
        for (std::size_t i = pairs_.size(); i-- > 0;) {
            alpha[i] = dot(pairs_[i].step, q) / pairs_[i].curvature;
            q -= alpha[i] * pairs_[i].change;
        }
        q = laplacian_.solve(q);
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
        if (pairs_.size() == tuning.history)
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
    const Laplacian& laplacian_;
    std::deque<Pair> pairs_;
};

// A descent: the current map, its energy and gradient, penalty included.
class Descent {
public:
    Descent(const FlatteningProblem& problem, const std::vector<std::uint8_t>& fixed,
            const ContactPenalty& penalty, Positions start)
        : problem_(problem), fixed_(fixed), penalty_(penalty), x_(std::move(start)) {
        energy_ = value(x_);
        shape_ = looked_at_;
        gradient_ = slope();
    }

    const Positions& x() const { return x_; }
    double energy() const { return energy_; }
    double shape() const { return shape_; } // the energy without the penalty
    const Positions& gradient() const { return gradient_; }

    /// Goes along a descent direction as far as pays; false if there is no such step.
    bool advance(Positions d) {
        hold_fixed(fixed_, d);
        const Positions start = x_;
        const auto energy_at = [this](const Positions& y) { return value(y); };
        if (!line_search(problem_, energy_at, d, dot(gradient_, d), x_, energy_))
            return false;
        shape_ = looked_at_;
        Positions gradient = slope();
        step_ = x_ - start;
        change_ = gradient - gradient_;
        gradient_ = std::move(gradient);
        return true;
    }
    const Positions& last_step() const { return step_; }
    const Positions& last_change() const { return change_; } // of the gradient

private:
    // Where contacts alone outweigh the energy at x, the faces need not be looked at: many steps
    // that are too long end so.
    double value(const Positions& y) {
        const double pressing = penalty_.energy(y);
        if (isometry + pressing > energy_)
            return infinite;
        looked_at_ = distortion_with_gradient(problem_, y, distortion_slope_);
        return looked_at_ + pressing;
    }
    // At x, where the energy was looked at last.
    Positions slope() {
        Positions g =
            energy_ < infinite ? std::move(distortion_slope_) : distortion_gradient(problem_, x_);
        penalty_.add_gradient(x_, g);
        hold_fixed(fixed_, g);
        return g;
    }

    const FlatteningProblem& problem_;
    const std::vector<std::uint8_t>& fixed_;
    const ContactPenalty& penalty_;
    Positions x_;
    // Without the penalty, where the energy was looked at last.
    Positions distortion_slope_;
    double looked_at_ = infinite;
    double energy_ = infinite;
    double shape_ = infinite;
    Positions gradient_;
    Positions step_;
    Positions change_;
};

bool is_hopeless(double energy, double last_gain, const SymmetricDirichletOptions& options) {
    return energy - gains_to_come * last_gain > options.give_up_energy;
}

// Newton's method until the map is near enough to an isometry for the Laplacian to be a good model
// of the Hessian, or until it gains little.
void approach(const FlatteningProblem& problem, const SymmetricDirichletOptions& options,
              const Progress& progress, Descent& descent, SymmetricDirichletResult& result) {
    // A penalty is none of the Hessian's business.
    const auto is_near = [&] { return descent.shape() < tuning.near_isometry; };
    if (is_near())
        return;
    ProjectedNewton newton(problem, options.fixed);
    while (result.iterations < options.max_iterations && !is_near()) {
        progress.check();
        const double before = descent.energy();
        if (!descent.advance(newton.direction(descent.x(), descent.gradient())))
            return;
        ++result.iterations;
        const double gain = before - descent.energy();
        if (gain < tuning.newton_gain * before || is_hopeless(descent.energy(), gain, options))
            return;
    }
}

void polish(const FlatteningProblem& problem, const SymmetricDirichletOptions& options,
            const Progress& progress, Descent& descent, SymmetricDirichletResult& result) {
    std::optional<Laplacian> own;
    if (options.laplacian == nullptr)
        own.emplace(problem, options.fixed);
    QuasiNewton model(own ? *own : *options.laplacian);
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
        if (recent.size() > tuning.stall_window) {
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
    SymmetricDirichletResult result;
    Descent descent(problem, options.fixed, penalty, positions_of(start));
    approach(problem, options, progress, descent, result);
    polish(problem, options, progress, descent, result);
    result.energy = descent.shape();
    result.uv = points_of(descent.x());
    return result;
}

double symmetric_dirichlet_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    return distortion(problem, positions_of(uv));
}

} // namespace devseg::flatten
