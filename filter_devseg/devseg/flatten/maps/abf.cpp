// References
//   [SLMB05] A. Sheffer, B. Lévy, M. Mogilnitsky, A. Bogomyakov: ABF++: Fast and Robust Angle Based
//            Flattening. ACM Transactions on Graphics 24(2), 2005. doi:10.1145/1061347.1061354
//   [ZLS07]  R. Zayer, B. Lévy, H.-P. Seidel: Linear Angle Based Parameterization. SGP 2007.
//            doi:10.2312/SGP/SGP07/135-141
// Deviations from [SLMB05]: wheels are compared by logarithms as in [ZLS07], which has the same
// solutions but does not lose small products. A step stops short of the first angle to vanish, and
// instead of another weight such an angle gets another Hessian, so that the energy stays the same.
#include "devseg/flatten/maps/abf.h"

#include <algorithm>
#include <cmath>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lscm.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    double way_to_flat = 0.9; // share of the way to the first angle of 0 or π that a step goes
    double shrunk = 0.25;     // share of its target below which an angle is in danger
};
constexpr Tuning tuning;

double cotangent(double angle) {
    return std::cos(angle) / std::sin(angle);
}

// Angle at corner c of face f: `cotangent` is numbered by the first corner of the opposite edge.
double rest_angle(const FlatteningProblem& problem, std::size_t f, std::size_t c) {
    return std::atan2(1.0, problem.cotangent[f][(c + 1) % 3]);
}

// What one face contributes; all quantities are of its three angles.
struct FaceTerms {
    Eigen::Vector3d inverse; // Λ⁻¹
    double trace;            // of Λ⁻¹
    Eigen::Matrix3d projected; // Λ⁻¹ − Λ⁻¹ 1 1ᵀ Λ⁻¹ / trace: keeps the sum of the angles
    Eigen::Matrix<double, 6, 3> gradient; // rows: vertex sums, then wheels of the corners 0, 1, 2
};

FaceTerms face_terms(const Eigen::Vector3d& inverse, const Eigen::Vector3d& angle) {
    FaceTerms face;
    face.inverse = inverse;
    face.trace = inverse.sum();
    face.gradient.setZero();
    for (int c = 0; c < 3; ++c) {
        const int next = (c + 1) % 3;
        const int previous = (c + 2) % 3;
        // Without cancellation, which would spoil flat triangles.
        face.projected(c, c) = inverse[c] * (inverse[next] + inverse[previous]) / face.trace;
        face.projected(c, next) = -inverse[c] * inverse[next] / face.trace;
        face.projected(c, previous) = -inverse[c] * inverse[previous] / face.trace;
        face.gradient(c, c) = 1.0;
        face.gradient(3 + c, next) = cotangent(angle[next]);
        face.gradient(3 + c, previous) = -cotangent(angle[previous]);
    }
    return face;
}

// Unknowns of a face in the reduced system, in the order of FaceTerms::gradient; −1 on the
// boundary.
Eigen::Matrix<Index, 6, 1> unknowns_of(const Triangle& face, const std::vector<Index>& place) {
    Eigen::Matrix<Index, 6, 1> unknowns;
    for (Index c = 0; c < 3; ++c) {
        const Index p = place[face[c]];
        unknowns[c] = p;
        unknowns[3 + c] = p < 0 ? -1 : p + 1;
    }
    return unknowns;
}

// The largest step up to 1 that keeps every angle between 0 and π.
double step_length(const Eigen::VectorXd& angles, const Eigen::VectorXd& change) {
    double step = 1.0;
    for (Eigen::Index i = 0; i < angles.size(); ++i) {
        const double room = change[i] < 0.0 ? angles[i] : pi - angles[i];
        if (std::abs(change[i]) * step > tuning.way_to_flat * room)
            step = tuning.way_to_flat * room / std::abs(change[i]);
    }
    return step;
}

} // namespace

AngleSystem::AngleSystem(const FlatteningProblem& problem, const AbfOptions& options)
    : problem_(problem), options_(options) {
    inner_.assign(at(problem.vertex_count), 0);
    for (const Vertex v : problem.boundary)
        inner_[v] = -1;
    for (const std::vector<Index>& hole : problem.holes)
        for (const Vertex v : hole)
            inner_[v] = -1;
    for (Index& number : inner_)
        if (number >= 0)
            number = inner_count_++;
    target_.resize(static_cast<Eigen::Index>(3 * problem.faces.size()));
    std::vector<double> sum(at(problem.vertex_count), 0.0);
    Eigen::Index i = 0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t c = 0; c < 3; ++c) {
            target_[i] = rest_angle(problem, f, c);
            sum[problem.faces[f][c]] += target_[i++];
        }
    i = 0;
    for (const Triangle& t : problem.faces)
        for (const Vertex v : t)
            target_[i++] *= inner_[v] >= 0 ? 2.0 * pi / sum[v] : 1.0;
    inverse_ = 0.5 * target_.cwiseAbs2();
    order_unknowns();
}

// Both unknowns of a vertex couple with the same others: ordering vertices instead is faster.
void AngleSystem::order_unknowns() {
    place_ = inner_;
    if (inner_count_ == 0)
        return;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(9 * problem_.faces.size());
    for (const Triangle& t : problem_.faces)
        for (const Vertex v : t)
            for (const Index w : t)
                if (inner_[v] >= 0 && inner_[w] >= 0)
                    entries.emplace_back(inner_[v], inner_[w], 1.0);
    Eigen::SparseMatrix<double> graph(inner_count_, inner_count_);
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(graph, order);
    std::vector<Index> place_of(at(inner_count_));
    for (Index p = 0; p < inner_count_; ++p)
        place_of[order.indices()[p]] = 2 * p;
    for (Index& p : place_)
        if (p >= 0)
            p = place_of[p];
}

Eigen::VectorXd AngleSystem::start() const {
    return target_.cwiseMax(options_.min_angle).cwiseMin(options_.max_angle);
}

double AngleSystem::energy(const Eigen::VectorXd& angles) const {
    return ((angles - target_).array() / target_.array()).square().sum();
}

Eigen::VectorXd AngleSystem::constraints(const Eigen::VectorXd& angles) const {
    const auto faces = static_cast<Eigen::Index>(problem_.faces.size());
    Eigen::VectorXd values(faces + inner_count_ + inner_count_);
    values.head(faces).setConstant(-pi);
    values.segment(faces, inner_count_).setConstant(-2.0 * pi);
    values.tail(inner_count_).setZero();
    Eigen::Index i = 0;
    for (Eigen::Index f = 0; f < faces; ++f)
        for (std::size_t c = 0; c < 3; ++c, ++i) {
            const Triangle& t = problem_.faces[static_cast<std::size_t>(f)];
            const Index own = inner_[t[c]];
            const Index ahead = inner_[t[(c + 2) % 3]]; // for it, this angle is the next one
            const Index behind = inner_[t[(c + 1) % 3]];
            const double log_sine = std::log(std::sin(angles[i]));
            values[f] += angles[i];
            if (own >= 0)
                values[faces + own] += angles[i];
            if (ahead >= 0)
                values[faces + inner_count_ + ahead] += log_sine;
            if (behind >= 0)
                values[faces + inner_count_ + behind] -= log_sine;
        }
    return values;
}

void AngleSystem::stiffen(const Eigen::VectorXd& angles) {
    for (Eigen::Index i = 0; i < angles.size(); ++i)
        if (angles[i] < tuning.shrunk * target_[i])
            inverse_[i] = std::min(inverse_[i], 0.5 * angles[i] * angles[i]);
}

// [SLMB05, section 3]. With Λ δα + J₁ᵀ μ₁ + J₂ᵀ μ₂ = −∇F, J₁ δα = −g₁ and J₂ δα = −g₂ for the
// faces' and the vertices' constraints, μ₁ is eliminated face by face: J₂ P J₂ᵀ μ₂ = g₂ + J₂ p,
// where P is FaceTerms::projected and p the step without μ₂. Leaves p and its μ₁ in `step`.
void AngleSystem::assemble(const Eigen::VectorXd& angles, Step& step) {
    const auto faces = static_cast<Eigen::Index>(problem_.faces.size());
    step = {Eigen::VectorXd(3 * faces), Eigen::VectorXd(faces + inner_count_ + inner_count_)};
    const Eigen::VectorXd values = constraints(angles);
    rhs_.resize(inner_count_ + inner_count_);
    for (std::size_t v = 0; v < place_.size(); ++v)
        if (place_[v] >= 0) {
            rhs_[place_[v]] = values[faces + inner_[v]];
            rhs_[place_[v] + 1] = values[faces + inner_count_ + inner_[v]];
        }
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(21 * problem_.faces.size());
    const Eigen::VectorXd descent =
        2.0 * inverse_.array() * (target_ - angles).array() / target_.array().square(); // −Λ⁻¹ ∇F
    for (Eigen::Index f = 0; f < faces; ++f) {
        const FaceTerms face = face_terms(inverse_.segment<3>(3 * f), angles.segment<3>(3 * f));
        step.multipliers[f] = (values[f] + descent.segment<3>(3 * f).sum()) / face.trace;
        step.angles.segment<3>(3 * f) =
            descent.segment<3>(3 * f) - step.multipliers[f] * face.inverse;
        const Eigen::Matrix<double, 6, 1> push = face.gradient * step.angles.segment<3>(3 * f);
        const Eigen::Matrix<double, 6, 6> block =
            face.gradient * face.projected * face.gradient.transpose();
        const auto unknowns = unknowns_of(problem_.faces[static_cast<std::size_t>(f)], place_);
        for (int i = 0; i < 6; ++i) {
            if (unknowns[i] < 0)
                continue;
            rhs_[unknowns[i]] += push[i];
            for (int j = 0; j < 6; ++j)
                if (unknowns[j] >= 0 && unknowns[j] <= unknowns[i])
                    entries.emplace_back(unknowns[i], unknowns[j], block(i, j));
        }
    }
    matrix_.resize(rhs_.size(), rhs_.size());
    matrix_.setFromTriplets(entries.begin(), entries.end());
}

// The multipliers of the last step are left out: constraints enter by their gradients only, so the
// step does not depend on them.
AngleSystem::Step AngleSystem::newton_step(const Eigen::VectorXd& angles) {
    Step step;
    assemble(angles, step);
    if (inner_count_ == 0)
        return step;
    if (!analysed_)
        solver_.analyzePattern(matrix_);
    analysed_ = true;
    solver_.factorize(matrix_);
    Eigen::VectorXd solution;
    if (solver_.info() == Eigen::Success)
        solution = solver_.solve(rhs_);
    if (solver_.info() != Eigen::Success || !solution.allFinite())
        throw NumericalFailure("expected solvable equations for the angles of a chart, found a "
                               "singular system");
    const auto faces = static_cast<Eigen::Index>(problem_.faces.size());
    for (Eigen::Index f = 0; f < faces; ++f) {
        const FaceTerms face = face_terms(inverse_.segment<3>(3 * f), angles.segment<3>(3 * f));
        const auto unknowns = unknowns_of(problem_.faces[static_cast<std::size_t>(f)], place_);
        Eigen::Vector3d pull = Eigen::Vector3d::Zero(); // J₂ᵀ μ₂
        for (int i = 0; i < 6; ++i)
            if (unknowns[i] >= 0)
                pull += solution[unknowns[i]] * face.gradient.row(i).transpose();
        step.angles.segment<3>(3 * f) -= face.projected * pull;
        step.multipliers[f] -= face.inverse.dot(pull) / face.trace;
    }
    for (std::size_t v = 0; v < place_.size(); ++v)
        if (place_[v] >= 0) {
            step.multipliers[faces + inner_[v]] = solution[place_[v]];
            step.multipliers[faces + inner_count_ + inner_[v]] = solution[place_[v] + 1];
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
        result.converged = length == 1.0 && result.residual <= constraint_met &&
                           change.lpNorm<Eigen::Infinity>() <= options.tolerance;
    }
    result.energy = system.energy(angles);
    progress.check();
    // Coordinates [SLMB05, section 4]: least squares over triangles of these angles. That is their
    // least squares conformal map, which knows triangles by their cotangents only.
    FlatteningProblem shaped = problem;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        Eigen::Vector3d angle = angles.segment<3>(static_cast<Eigen::Index>(3 * f));
        angle *= pi / angle.sum();
        for (std::size_t k = 0; k < 3; ++k) // opposite to the edge k → k + 1
            shaped.cotangent[f][k] = cotangent(angle[static_cast<Eigen::Index>((k + 2) % 3)]);
    }
    result.uv = flatten_lscm(shaped);
    result.flips = count_flips(problem, result.uv);
    return result;
}

} // namespace devseg::flatten
