// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
//   [Flo03] M. S. Floater: Mean Value Coordinates. Computer Aided Geometric Design 20(1), 2003.
//           doi:10.1016/S0167-8396(03)00002-5
#include "devseg/flatten/lpfb.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include "devseg/errors.h"
#include "devseg/flatten/map_tools.h"

namespace devseg {

namespace {

constexpr double pi = 3.14159265358979323846;
// A boundary counts as closed at this share of its length: what rounding leaves over a few
// thousand edges.
constexpr double closed = 1e-12;
constexpr double smallest_step = 1e-6; // of the line search

using Angles = Eigen::VectorXd;

// The three conditions of a closed boundary [Wan08], as a share of its length where they are
// lengths, and their derivatives: Σ (π − θ) = 2π, Σ l cos φ = 0, Σ l sin φ = 0, where edge i has
// the direction φ_i = Σ_{b ≤ i} (π − θ_b).
struct Closure {
    Eigen::Vector3d value;
    Eigen::Matrix3Xd gradient;
};

Eigen::Vector3d closure_value(const Eigen::VectorXd& lengths, const Angles& theta) {
    const auto n = static_cast<double>(theta.size());
    Eigen::Vector3d value((n - 2.0) * pi - theta.sum(), 0.0, 0.0);
    double phi = 0.0;
    for (Eigen::Index i = 0; i < theta.size(); ++i) {
        phi += pi - theta[i];
        value[1] += lengths[i] * std::cos(phi);
        value[2] += lengths[i] * std::sin(phi);
    }
    return value;
}

Closure closure_of(const Eigen::VectorXd& lengths, const Angles& theta) {
    Closure closure;
    const auto n = static_cast<double>(theta.size());
    closure.value = Eigen::Vector3d((n - 2.0) * pi - theta.sum(), 0.0, 0.0);
    closure.gradient.resize(3, theta.size());
    closure.gradient.row(0).setConstant(-1.0);
    double phi = 0.0;
    for (Eigen::Index i = 0; i < theta.size(); ++i) {
        phi += pi - theta[i];
        closure.gradient(1, i) = lengths[i] * std::sin(phi);
        closure.gradient(2, i) = -lengths[i] * std::cos(phi);
        closure.value[1] -= closure.gradient(2, i);
        closure.value[2] += closure.gradient(1, i);
    }
    // An angle turns all later edges.
    for (Eigen::Index i = theta.size() - 1; i > 0; --i)
        closure.gradient.col(i - 1).tail<2>() += closure.gradient.col(i).tail<2>();
    return closure;
}

// The least vector d with gradient · d = rhs.
Angles least_norm(const Eigen::Matrix3Xd& gradient, const Eigen::Vector3d& rhs) {
    const Eigen::Matrix3d gram = gradient * gradient.transpose();
    return gradient.transpose() * gram.completeOrthogonalDecomposition().solve(rhs);
}

// Least-norm steps on the linearised conditions; a step is halved until the conditions are less
// violated, which a small enough one achieves wherever the gradients are independent.
bool close_by_least_norm(const Eigen::VectorXd& lengths, Angles& theta, int max_rounds,
                         int& rounds, const Progress& progress) {
    for (int k = 0; k < max_rounds; ++k) {
        progress.check();
        const Closure closure = closure_of(lengths, theta);
        const double violation = closure.value.norm();
        if (violation <= closed)
            return true;
        const Angles step = -least_norm(closure.gradient, closure.value);
        if (!step.allFinite())
            return false;
        double share = 1.0;
        while (share > smallest_step &&
               !(closure_value(lengths, theta + share * step).norm() < (1.0 - 0.5 * share) * violation))
            share *= 0.5;
        if (share <= smallest_step)
            return false;
        theta += share * step;
        ++rounds;
    }
    return false;
}

// [Wan08]: Newton steps without second derivatives. The multipliers do not matter for the steps,
// because the energy is quadratic, so they are left out.
bool close_by_newton(const Eigen::VectorXd& lengths, const Angles& target, Angles& theta,
                     const LpfbOptions& options, int& rounds, const Progress& progress) {
    for (int k = 0; k < options.max_rounds; ++k) {
        progress.check();
        const Closure closure = closure_of(lengths, theta);
        const Angles back = target - theta;
        const Angles step =
            back - least_norm(closure.gradient, closure.gradient * back + closure.value);
        if (!step.allFinite())
            return false;
        theta += step;
        ++rounds;
        if (step.lpNorm<Eigen::Infinity>() <= options.tolerance)
            return close_by_least_norm(lengths, theta, options.max_rounds, rounds, progress);
    }
    return false;
}

} // namespace

ClosedBoundary close_boundary(const std::vector<double>& lengths,
                              const std::vector<double>& targets, const LpfbOptions& options,
                              const Progress& progress) {
    const std::size_t count = lengths.size();
    const double perimeter = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    // The longest edge comes last: it is the one that takes up the rounding of all others.
    const std::size_t first =
        static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) -
                                 lengths.begin()) + 1;
    Eigen::VectorXd share(static_cast<Eigen::Index>(count));
    Angles target(share.size());
    for (std::size_t i = 0; i < count; ++i) {
        share[static_cast<Eigen::Index>(i)] = lengths[(first + i) % count] / perimeter;
        target[static_cast<Eigen::Index>(i)] = targets[(first + i) % count];
    }
    ClosedBoundary result;
    Angles theta = target;
    if (!close_by_newton(share, target, theta, options, result.rounds, progress)) {
        result.solver = BoundarySolver::newton_from_closed;
        Angles near = target;
        if (!close_by_least_norm(share, near, options.max_rounds, result.rounds, progress))
            throw NumericalFailure("expected a boundary that can be closed in the plane, found " +
                                   std::to_string(count) + " edges that cannot");
        theta = near;
        if (!close_by_newton(share, target, theta, options, result.rounds, progress)) {
            result.solver = BoundarySolver::least_norm;
            theta = near;
        }
    }
    result.closure = closure_value(share, theta).tail<2>().norm();
    result.deviation = std::sqrt((theta - target).squaredNorm() / static_cast<double>(count));
    result.angles.resize(count);
    result.points.resize(count);
    Vec2 point = Vec2::Zero();
    double phi = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        phi += pi - theta[row];
        result.angles[(first + i) % count] = theta[row];
        result.points[(first + i) % count] = point;
        point += lengths[(first + i) % count] * Vec2(std::cos(phi), std::sin(phi));
    }
    return result;
}

namespace {

// Weights of the inner vertices' balance, as numbers of a face's half-edges: weight(f, k) pulls
// corner k towards corner k + 1, and weight_back(f, k) the other way.
struct Interior {
    std::vector<Index> slot; // #v: number of the unknown, −1 on the boundary
    Index unknowns = 0;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX2d rhs;

    void pull(Index i, Index j, double w, const std::vector<Vec2>& uv) {
        if (slot[at(i)] < 0)
            return;
        entries.emplace_back(slot[at(i)], slot[at(i)], w);
        if (slot[at(j)] < 0)
            rhs.row(slot[at(i)]) += w * uv[at(j)].transpose();
        else
            entries.emplace_back(slot[at(i)], slot[at(j)], -w);
    }
};

// tan of half of the angle with this cotangent.
double half_tangent(double cotangent) {
    const double root = std::sqrt(1.0 + cotangent * cotangent);
    return cotangent > 0.0 ? 1.0 / (root + cotangent) : root - cotangent;
}

template <class Solver>
bool solve_interior(const Interior& interior, std::vector<Vec2>& uv) {
    Eigen::SparseMatrix<double> matrix(interior.unknowns, interior.unknowns);
    matrix.setFromTriplets(interior.entries.begin(), interior.entries.end());
    Solver solver;
    solver.compute(matrix);
    if (solver.info() != Eigen::Success)
        return false;
    const Eigen::MatrixX2d solution = solver.solve(interior.rhs);
    if (!solution.allFinite())
        return false;
    for (std::size_t v = 0; v < uv.size(); ++v)
        if (interior.slot[v] >= 0)
            uv[v] = solution.row(interior.slot[v]).transpose();
    return true;
}

void balance_cotangent(const FlatteningProblem& problem, Interior& interior,
                       const std::vector<Vec2>& uv) {
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index i = problem.faces[f][k];
            const Index j = problem.faces[f][(k + 1) % 3];
            interior.pull(i, j, problem.cotangent[f][k], uv);
            interior.pull(j, i, problem.cotangent[f][k], uv);
        }
}

void balance_mean_value(const FlatteningProblem& problem, Interior& interior,
                        const std::vector<Vec2>& uv) {
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d& edges = problem.edges[f];
        const std::array<double, 3> length = {edges.col(0).norm(),
                                              (edges.col(1) - edges.col(0)).norm(),
                                              edges.col(1).norm()};
        for (std::size_t k = 0; k < 3; ++k) {
            const double w = half_tangent(problem.cotangent[f][(k + 1) % 3]);
            interior.pull(problem.faces[f][k], problem.faces[f][(k + 1) % 3], w / length[k], uv);
            interior.pull(problem.faces[f][k], problem.faces[f][(k + 2) % 3],
                          w / length[(k + 2) % 3], uv);
        }
    }
}

} // namespace

LpfbResult flatten_lpfb(const FlatteningProblem& problem, const LpfbOptions& options,
                        const Progress& progress) {
    std::vector<double> sum(at(problem.vertex_count), 0.0);
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t c = 0; c < 3; ++c)
            sum[at(problem.faces[f][c])] += std::atan2(1.0, problem.cotangent[f][(c + 1) % 3]);
    std::vector<double> targets;
    for (const Index v : problem.boundary)
        targets.push_back(sum[at(v)]);
    LpfbResult result;
    result.boundary = close_boundary(problem.boundary_edge, targets, options, progress);
    result.uv.assign(at(problem.vertex_count), Vec2::Zero());
    Interior interior;
    interior.slot.assign(at(problem.vertex_count), 0);
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        result.uv[at(problem.boundary[i])] = result.boundary.points[i];
        interior.slot[at(problem.boundary[i])] = -1;
    }
    for (Index& s : interior.slot)
        if (s >= 0)
            s = interior.unknowns++;
    result.flips = count_flips(problem, result.uv);
    if (interior.unknowns == 0)
        return result;
    using Symmetric = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
    using General = Eigen::SparseLU<Eigen::SparseMatrix<double>>;
    interior.rhs = Eigen::MatrixX2d::Zero(interior.unknowns, 2);
    balance_cotangent(problem, interior, result.uv);
    progress.check();
    const bool solved = solve_interior<Symmetric>(interior, result.uv);
    result.flips = count_flips(problem, result.uv);
    if (solved && result.flips == 0)
        return result;
    std::vector<Vec2> other = result.uv;
    interior.entries.clear();
    interior.rhs.setZero();
    balance_mean_value(problem, interior, other);
    progress.check();
    if (solve_interior<General>(interior, other)) {
        const Index flips = count_flips(problem, other);
    if (getenv("ABF_DEBUG")) fprintf(stderr, "  lpfb flips cot %d mvc %d\n", result.flips, flips);
        if (!solved || flips < result.flips) {
            result.uv = std::move(other);
            result.flips = flips;
            result.mean_value = true;
        }
    } else if (!solved) {
        throw NumericalFailure("expected solvable equations for the inside of a chart, found a "
                               "singular system");
    }
    return result;
}

} // namespace devseg
