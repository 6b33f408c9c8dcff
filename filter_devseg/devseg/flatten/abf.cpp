// References
//   [SLMB05] A. Sheffer, B. Lévy, M. Mogilnitsky, A. Bogomyakov: ABF++: Fast and Robust Angle Based
//            Flattening. ACM Transactions on Graphics 24(2), 2005. doi:10.1145/1061347.1061354
//   [ZLS07]  R. Zayer, B. Lévy, H.-P. Seidel: Linear Angle Based Parameterization. SGP 2007.
//            doi:10.2312/SGP/SGP07/135-141
// Deviations from [SLMB05]: wheels are compared by logarithms as in [ZLS07], which has the same
// solutions but does not lose small products. A step stops short of the first angle to vanish, and
// instead of another weight such an angle gets another Hessian, so that the energy stays the same.
#include "devseg/flatten/abf.h"

#include <algorithm>
#include <cmath>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>

#include "devseg/errors.h"
#include "devseg/flatten/lscm.h"
#include "devseg/flatten/map_tools.h"

namespace devseg {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double safe_step = 0.9; // share of the way to the first angle of 0 or π
// Violation at which constraints count as met: far below what a flipped triangle needs, far above
// rounding.
constexpr double met = 1e-8;
constexpr double shrunk = 0.25; // share of its target below which an angle is in danger
using Block = Eigen::Matrix<double, 6, 3>;

std::size_t next(std::size_t corner) {
    return (corner + 1) % 3;
}

double cotangent(double angle) {
    return std::cos(angle) / std::sin(angle);
}

// Angle at corner c of face f: `cotangent` is numbered by the opposite edge's first corner.
double rest_angle(const FlatteningProblem& problem, std::size_t f, std::size_t c) {
    return std::atan2(1.0, problem.cotangent[f][next(c)]);
}

// What one face contributes. All quantities are of its three angles.
struct Face {
    Eigen::Vector3d inverse;   // Λ⁻¹, the inverse Hessian
    double trace;              // of Λ⁻¹
    Eigen::Matrix3d projected; // Λ⁻¹ − Λ⁻¹ 1 1ᵀ Λ⁻¹ / trace: the sum of the angles is eliminated
    Block gradient;            // rows: vertex sums, then wheels of the corners 0, 1, 2
};

Face face_terms(const Eigen::Vector3d& inverse, const Eigen::Vector3d& angle) {
    Face face;
    face.inverse = inverse;
    face.trace = inverse.sum();
    for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d)
            face.projected(c, d) =
                face.inverse[c] * (c == d ? face.inverse[(c + 1) % 3] + face.inverse[(c + 2) % 3]
                                          : -face.inverse[d]) / face.trace;
    face.gradient.setZero();
    for (int c = 0; c < 3; ++c) {
        face.gradient(c, c) = 1.0;
        face.gradient(3 + c, (c + 1) % 3) = cotangent(angle[(c + 1) % 3]);
        face.gradient(3 + c, (c + 2) % 3) = -cotangent(angle[(c + 2) % 3]);
    }
    return face;
}

// The largest step up to 1 that keeps every angle between 0 and π.
double step_length(const Eigen::VectorXd& angles, const Eigen::VectorXd& change) {
    double step = 1.0;
    for (Eigen::Index i = 0; i < angles.size(); ++i) {
        const double room = change[i] < 0.0 ? angles[i] : pi - angles[i];
        if (std::abs(change[i]) * step > safe_step * room)
            step = safe_step * room / std::abs(change[i]);
    }
    return step;
}

} // namespace

struct AngleSystem::Solver {
    // Unknowns come in the order of elimination, both of a vertex together.
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
        factors;
    bool analysed = false;
};

AngleSystem::AngleSystem(const FlatteningProblem& problem, const AbfOptions& options)
    : problem_(problem), options_(options), solver_(std::make_unique<Solver>()) {
    inner_.assign(at(problem.vertex_count), 0);
    for (const Index v : problem.boundary)
        inner_[at(v)] = -1;
    for (Index& number : inner_)
        if (number >= 0)
            number = inner_count_++;
    std::vector<double> sum(at(problem.vertex_count), 0.0);
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t c = 0; c < 3; ++c)
            sum[at(problem.faces[f][c])] += rest_angle(problem, f, c);
    target_.resize(static_cast<Eigen::Index>(3 * problem.faces.size()));
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t v = at(problem.faces[f][c]);
            const double ratio = inner_[v] >= 0 ? 2.0 * pi / sum[v] : 1.0;
            target_[static_cast<Eigen::Index>(3 * f + c)] = ratio * rest_angle(problem, f, c);
        }
    inverse_ = 0.5 * target_.cwiseAbs2();
    order_unknowns();
}

AngleSystem::~AngleSystem() = default;

void AngleSystem::order_unknowns() {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Triangle& t : problem_.faces)
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t d = 0; d < 3; ++d)
                if (inner_[at(t[c])] >= 0 && inner_[at(t[d])] >= 0)
                    entries.emplace_back(inner_[at(t[c])], inner_[at(t[d])], 1.0);
    Eigen::SparseMatrix<double> graph(inner_count_, inner_count_);
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    if (inner_count_ > 0)
        Eigen::AMDOrdering<int>()(graph, order);
    const Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> place = order.inverse();
    row_ = inner_;
    for (Index& row : row_)
        if (row >= 0)
            row = place.indices()[row];
}

Eigen::VectorXd AngleSystem::start() const {
    return target_.cwiseMax(options_.min_angle).cwiseMin(options_.max_angle);
}

double AngleSystem::energy(const Eigen::VectorXd& angles) const {
    return ((angles - target_).array() / target_.array()).square().sum();
}

Eigen::VectorXd AngleSystem::constraints(const Eigen::VectorXd& angles) const {
    const auto faces = static_cast<Eigen::Index>(problem_.faces.size());
    Eigen::VectorXd values = Eigen::VectorXd::Zero(faces + 2 * inner_count_);
    values.head(faces).setConstant(-pi);
    values.segment(faces, inner_count_).setConstant(-2.0 * pi);
    for (Eigen::Index f = 0; f < faces; ++f)
        for (Eigen::Index c = 0; c < 3; ++c) {
            values[f] += angles[3 * f + c];
            const double log_sine = std::log(std::sin(angles[3 * f + c]));
            const Triangle& t = problem_.faces[static_cast<std::size_t>(f)];
            const auto corner = static_cast<std::size_t>(c);
            const Index own = inner_[at(t[corner])];
            const Index before = inner_[at(t[next(next(corner))])]; // this angle is its next one
            const Index after = inner_[at(t[next(corner)])];
            if (own >= 0)
                values[faces + own] += angles[3 * f + c];
            if (before >= 0)
                values[faces + inner_count_ + before] += log_sine;
            if (after >= 0)
                values[faces + inner_count_ + after] -= log_sine;
        }
    return values;
}

void AngleSystem::stiffen(const Eigen::VectorXd& angles) {
    for (Eigen::Index i = 0; i < angles.size(); ++i)
        if (angles[i] < shrunk * target_[i])
            inverse_[i] = std::min(inverse_[i], 0.5 * angles[i] * angles[i]);
}

// [SLMB05, section 3] with the multipliers of the last step left out: constraints enter by their
// gradients only, so the step does not depend on them.
AngleSystem::Step AngleSystem::newton_step(const Eigen::VectorXd& angles) {
    const auto faces = static_cast<Eigen::Index>(problem_.faces.size());
    const Eigen::VectorXd values = constraints(angles);
    const Eigen::VectorXd slope = 2.0 * (target_ - angles).array() / target_.array().square();
    Step step{Eigen::VectorXd(3 * faces), Eigen::VectorXd::Zero(faces + 2 * inner_count_)};
    const auto rows_of = [&](Eigen::Index f, std::array<Index, 6>& rows) {
        for (std::size_t c = 0; c < 3; ++c) {
            const Index row = row_[at(problem_.faces[static_cast<std::size_t>(f)][c])];
            rows[c] = row < 0 ? -1 : 2 * row;
            rows[3 + c] = row < 0 ? -1 : 2 * row + 1;
        }
    };
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(21 * problem_.faces.size());
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(2 * inner_count_);
    for (std::size_t v = 0; v < row_.size(); ++v)
        if (row_[v] >= 0) {
            rhs[2 * row_[v]] = values[faces + inner_[v]];
            rhs[2 * row_[v] + 1] = values[faces + inner_count_ + inner_[v]];
        }
    std::array<Index, 6> rows{};
    for (Eigen::Index f = 0; f < faces; ++f) {
        const Face face = face_terms(inverse_.segment<3>(3 * f), angles.segment<3>(3 * f));
        // Down the energy, and from there to a sum of π.
        const Eigen::Vector3d descent = face.inverse.cwiseProduct(slope.segment<3>(3 * f));
        step.multipliers[f] =
            (angles.segment<3>(3 * f).sum() + descent.sum() - pi) / face.trace;
        step.angles.segment<3>(3 * f) = descent - step.multipliers[f] * face.inverse;
        const Eigen::Matrix<double, 6, 1> push = face.gradient * step.angles.segment<3>(3 * f);
        const Eigen::Matrix<double, 6, 6> block =
            face.gradient * face.projected * face.gradient.transpose();
        rows_of(f, rows);
        for (std::size_t i = 0; i < 6; ++i) {
            if (rows[i] < 0)
                continue;
            rhs[rows[i]] += push[static_cast<Eigen::Index>(i)];
            for (std::size_t j = 0; j < 6; ++j)
                if (rows[j] >= 0 && rows[j] <= rows[i])
                    entries.emplace_back(rows[i], rows[j],
                                         block(static_cast<Eigen::Index>(i),
                                               static_cast<Eigen::Index>(j)));
        }
    }
    Eigen::VectorXd solution = rhs;
    if (inner_count_ > 0) {
        Eigen::SparseMatrix<double> matrix(2 * inner_count_, 2 * inner_count_);
        matrix.setFromTriplets(entries.begin(), entries.end());
        if (!solver_->analysed)
            solver_->factors.analyzePattern(matrix);
        solver_->analysed = true;
        solver_->factors.factorize(matrix);
        if (solver_->factors.info() == Eigen::Success)
            solution = solver_->factors.solve(rhs);
        if (solver_->factors.info() != Eigen::Success || !solution.allFinite())
            throw NumericalFailure("expected solvable equations for the angles of a chart, found a "
                                   "singular system");
    }
    for (Eigen::Index f = 0; f < faces; ++f) {
        const Face face = face_terms(inverse_.segment<3>(3 * f), angles.segment<3>(3 * f));
        rows_of(f, rows);
        Eigen::Vector3d pull = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < 6; ++i)
            if (rows[i] >= 0)
                pull += solution[rows[i]] *
                        face.gradient.row(static_cast<Eigen::Index>(i)).transpose();
        step.angles.segment<3>(3 * f) -= face.projected * pull;
        step.multipliers[f] -= face.inverse.dot(pull) / face.trace;
    }
    for (std::size_t v = 0; v < row_.size(); ++v)
        if (row_[v] >= 0) {
            step.multipliers[faces + inner_[v]] = solution[2 * row_[v]];
            step.multipliers[faces + inner_count_ + inner_[v]] = solution[2 * row_[v] + 1];
        }
    return step;
}

AbfResult flatten_abf(const FlatteningProblem& problem, const AbfOptions& options,
                      const Progress& progress) {
    AngleSystem system(problem, options);
    Eigen::VectorXd angles = system.start();
    AbfResult result;
    while (result.iterations < options.max_iterations && !result.converged) {
        progress.check();
        const Eigen::VectorXd change = system.newton_step(angles).angles;
        const double length = step_length(angles, change);
        angles += length * change;
        if (length < 1.0)
            system.stiffen(angles);
        ++result.iterations;
        result.residual = system.constraints(angles).lpNorm<Eigen::Infinity>();
        result.converged = length == 1.0 && result.residual <= met &&
                           change.lpNorm<Eigen::Infinity>() <= options.tolerance;
        if (getenv("ABF_DEBUG")) fprintf(stderr, "  it %d len %g change %g res %g E %g\n", result.iterations, length, change.lpNorm<Eigen::Infinity>(), result.residual, system.energy(angles));
    }
    result.energy = system.energy(angles);
    progress.check();
    // Coordinates [SLMB05, section 4]: least squares over triangles of these angles, which is a
    // least squares conformal map of them, for that knows triangles by their cotangents only.
    FlatteningProblem shaped = problem;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        Eigen::Vector3d angle = angles.segment<3>(static_cast<Eigen::Index>(3 * f));
        angle *= pi / angle.sum();
        for (std::size_t k = 0; k < 3; ++k)
            shaped.cotangent[f][k] = cotangent(angle[static_cast<Eigen::Index>(next(next(k)))]);
    }
    result.uv = flatten_lscm(shaped);
    result.flips = count_flips(problem, result.uv);
    return result;
}

} // namespace devseg
