// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
#include "devseg/flatten/maps/lpfb.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/harmonic.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    double gap = 1e-12;               // share of a boundary's length that may be left open
    double gap_of_edge = 1e-15;       // and what each edge may add to it
    double pull_shift = 1e-12;        // keeps straight polygons solvable
    double least_inner_weight = 0.02; // blunt triangles would turn others over
};
constexpr Tuning tuning;

// The three conditions of a closed boundary [Wan08], as a share of its length where they are
// lengths, and their derivatives: Σ (π − θ) = 2π, Σ l cos φ = 0, Σ l sin φ = 0, where edge i has
// the direction φ_i = Σ_{b ≤ i} (π − θ_b).
struct Closure {
    Eigen::Vector3d value;
    Eigen::Matrix3Xd gradient;
};

Closure closure_of(const Eigen::VectorXd& lengths, const Eigen::VectorXd& theta) {
    Closure closure{Eigen::Vector3d::Zero(), Eigen::Matrix3Xd(3, theta.size())};
    double phi = 0.0;
    for (Eigen::Index i = 0; i < theta.size(); ++i) {
        phi += pi - theta[i];
        const Vec2 edge = lengths[i] * Vec2(std::cos(phi), std::sin(phi));
        closure.value.tail<2>() += edge;
        closure.gradient.col(i) << -1.0, edge.y(), -edge.x();
    }
    closure.value[0] = phi - 2.0 * pi;
    // An angle turns all later edges.
    for (Eigen::Index i = theta.size() - 1; i > 0; --i)
        closure.gradient.col(i - 1).tail<2>() += closure.gradient.col(i).tail<2>();
    return closure;
}

// The least vector d with gradient · d = rhs.
Eigen::VectorXd least_norm(const Eigen::Matrix3Xd& gradient, const Eigen::Vector3d& rhs) {
    const Eigen::Matrix3d gram = gradient * gradient.transpose();
    return gradient.transpose() * gram.completeOrthogonalDecomposition().solve(rhs);
}

// Least-norm steps on the linearised conditions. A step is halved until the conditions are less
// violated, which a small enough one achieves wherever their gradients are independent.
bool close_by_least_norm(const Eigen::VectorXd& lengths, Eigen::VectorXd& theta, int max_rounds,
                         int& rounds, const Progress& progress) {
    const double enough = tuning.gap + tuning.gap_of_edge * static_cast<double>(theta.size());
    Closure closure = closure_of(lengths, theta);
    for (int k = 0; k < max_rounds && closure.value.norm() > enough; ++k, ++rounds) {
        progress.check();
        const double violation = closure.value.norm();
        const Eigen::VectorXd from = theta;
        const Eigen::VectorXd step = -least_norm(closure.gradient, closure.value);
        double share = 2.0;
        do {
            share *= 0.5;
            theta = from + share * step;
            closure = closure_of(lengths, theta);
        } while (theta != from && !(closure.value.norm() < (1.0 - 0.5 * share) * violation));
        if (theta == from)
            return false;
    }
    return closure.value.norm() <= enough;
}

// [Wan08]: Newton steps without second derivatives. The multipliers do not matter for the steps,
// because the energy is quadratic, so they are left out.
bool close_by_newton(const Eigen::VectorXd& lengths, const Eigen::VectorXd& target,
                     Eigen::VectorXd& theta, const LpfbOptions& options, int& rounds,
                     const Progress& progress) {
    for (int k = 0; k < options.max_rounds; ++k) {
        progress.check();
        const Closure closure = closure_of(lengths, theta);
        const Eigen::VectorXd back = target - theta;
        const Eigen::VectorXd step =
            back - least_norm(closure.gradient, closure.gradient * back + closure.value);
        theta += step;
        ++rounds;
        if (!theta.allFinite())
            return false;
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
    const auto size = static_cast<Eigen::Index>(count);
    Eigen::VectorXd share = Eigen::Map<const Eigen::VectorXd>(lengths.data(), size);
    share /= share.sum();
    const Eigen::VectorXd target = Eigen::Map<const Eigen::VectorXd>(targets.data(), size);
    ClosedBoundary result;
    Eigen::VectorXd theta = target;
    Eigen::VectorXd near = target;
    if (!close_by_newton(share, target, theta, options, result.rounds, progress)) {
        result.solver = BoundarySolver::newton_from_closed;
        if (!close_by_least_norm(share, near, options.max_rounds, result.rounds, progress))
            throw NumericalFailure("expected a boundary that can be closed in the plane, found " +
                                   std::to_string(count) + " edges that cannot");
        theta = near;
        if (!close_by_newton(share, target, theta, options, result.rounds, progress)) {
            result.solver = BoundarySolver::least_norm;
            theta = near;
        }
    }
    result.closure = closure_of(share, theta).value.tail<2>().norm();
    result.deviation = std::sqrt((theta - target).squaredNorm() / static_cast<double>(count));
    result.angles.assign(theta.data(), theta.data() + size);
    result.points.resize(count);
    // The walk ends with the longest edge, which takes up the rounding of all others.
    const auto last = std::max_element(lengths.begin(), lengths.end()) - lengths.begin();
    Vec2 point = Vec2::Zero();
    double phi = 0.0;
    for (std::size_t k = 1; k <= count; ++k) {
        const std::size_t i = (static_cast<std::size_t>(last) + k) % count;
        phi += pi - result.angles[i];
        result.points[i] = point;
        point += lengths[i] * Vec2(std::cos(phi), std::sin(phi));
    }
    return result;
}

std::vector<double> boundary_angles(const FlatteningProblem& problem,
                                    const std::vector<Vec2>& map) {
    std::vector<Index> place(at(problem.vertex_count), -1);
    for (std::size_t i = 0; i < problem.boundary.size(); ++i)
        place[problem.boundary[i]] = static_cast<Index>(i);
    std::vector<double> angles(problem.boundary.size(), 0.0);
    for (Face f = 0; f < static_cast<Index>(problem.faces.size()); ++f)
        for (Index c = 0; c < 3; ++c) {
            const auto corner = [&](Index k) {
                return map.empty() ? problem.corner(f, k) : map[problem.faces[f][k]];
            };
            const Index i = place[problem.faces[f][c]];
            if (i < 0)
                continue;
            const Vec2 p = corner((c + 1) % 3) - corner(c);
            const Vec2 q = corner((c + 2) % 3) - corner(c);
            angles[i] += plane::signed_angle(p, q);
        }
    return angles;
}

LpfbResult flatten_lpfb(const FlatteningProblem& problem, const std::vector<double>& targets,
                        const LpfbOptions& options, const Progress& progress) {
    expect_no_holes(problem);
    LpfbResult result;
    result.boundary = close_boundary(problem.boundary_edge, targets, options, progress);
    result.uv.assign(at(problem.vertex_count), Vec2::Zero());
    for (std::size_t i = 0; i < problem.boundary.size(); ++i)
        result.uv[problem.boundary[i]] = result.boundary.points[i];
    progress.check();
    const HarmonicMap interior(problem, result.uv);
    result.flips = count_flips(problem, result.uv);
    progress.check();
    std::vector<Vec2> uv = result.uv;
    const Index mended = result.flips > 0 ? interior.mend(uv) : 0;
    const Index flips = mended > 0 ? count_flips(problem, uv) : result.flips;
    if (flips < result.flips) {
        result.uv = std::move(uv);
        result.flips = flips;
        result.mended = mended;
    }
    return result;
}

LpfbResult flatten_lpfb(const FlatteningProblem& problem, const LpfbOptions& options,
                        const Progress& progress) {
    return flatten_lpfb(problem, boundary_angles(problem), options, progress);
}

std::optional<std::vector<Vec2>> restore_lengths(std::vector<Vec2> points,
                                                 const std::vector<double>& lengths,
                                                 const Progress& progress) {
    const auto count = static_cast<Index>(points.size());
    const auto next = [&](Index i) { return i + 1 < count ? i + 1 : 0; };
    std::vector<Vec2> direction(points.size());
    Eigen::VectorXd excess(count);
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
    for (int step = 0; step < LpfbOptions{}.max_rounds; ++step) {
        progress.check();
        bool is_settled = true;
        for (Index i = 0; i < count; ++i) {
            const Vec2 edge = points[next(i)] - points[i];
            if (!(edge.norm() > 0.0))
                return std::nullopt;
            direction[i] = edge.normalized();
            excess[i] = edge.norm() - lengths[i];
            is_settled = is_settled && std::abs(excess[i]) <= constraint_met * lengths[i];
        }
        if (is_settled)
            return points;
        std::vector<Eigen::Triplet<double>> entries;
        for (Index i = 0; i < count; ++i) {
            const double turn = -direction[i].dot(direction[next(i)]);
            entries.emplace_back(i, i, 2.0 + tuning.pull_shift);
            entries.emplace_back(i, next(i), turn);
            entries.emplace_back(next(i), i, turn);
        }
        Eigen::SparseMatrix<double> matrix(count, count);
        matrix.setFromTriplets(entries.begin(), entries.end());
        if (step == 0)
            solver.analyzePattern(matrix);
        solver.factorize(matrix);
        const Eigen::VectorXd pull = solver.solve(excess);
        if (solver.info() != Eigen::Success || !pull.allFinite())
            return std::nullopt;
        for (Index i = 0; i < count; ++i) {
            points[i] += pull[i] * direction[i];
            points[next(i)] -= pull[i] * direction[i];
        }
    }
    return std::nullopt;
}

namespace {

// Length of the boundary edge that leaves each vertex (#v); 0 inside.
std::vector<double> boundary_lengths(const FlatteningProblem& problem) {
    std::vector<double> length(at(problem.vertex_count), 0.0);
    for (HalfEdge h = 0; h < static_cast<Index>(problem.twin.size()); ++h) {
        const Face f = face_of(h);
        if (problem.twin[h] < 0)
            length[problem.faces[f][corner_of(h)]] =
                (problem.corner(f, corner_of(Mesh::next(h))) - problem.corner(f, corner_of(h)))
                    .norm();
    }
    for (std::size_t i = 0; i < problem.boundary.size(); ++i)
        length[problem.boundary[i]] = problem.boundary_edge[i];
    return length;
}

} // namespace

std::optional<std::vector<Vec2>> restore_seam_lengths(const FlatteningProblem& problem,
                                                      const std::vector<Vec2>& uv,
                                                      const Progress& progress) {
    std::vector<Vec2> placed = uv; // on the boundary
    std::vector<std::vector<Index>> rings = problem.holes;
    rings.push_back(problem.boundary);
    const std::vector<double> length = boundary_lengths(problem);
    for (const std::vector<Index>& ring : rings) {
        std::vector<Vec2> points;
        std::vector<double> lengths;
        for (const Vertex v : ring) {
            points.push_back(uv[v]);
            lengths.push_back(length[v]);
        }
        const auto restored = restore_lengths(std::move(points), lengths, progress);
        if (!restored)
            return std::nullopt;
        for (std::size_t i = 0; i < ring.size(); ++i)
            placed[ring[i]] = (*restored)[i];
    }
    std::vector<Vec2> moves;
    for (std::size_t v = 0; v < uv.size(); ++v)
        moves.push_back(placed[v] - uv[v]);
    HarmonicMap(problem, moves,
                [](double cotangent) { return std::max(tuning.least_inner_weight, cotangent); });
    std::vector<Vec2> result = uv;
    for (std::size_t v = 0; v < result.size(); ++v)
        result[v] += moves[v];
    // Exactly, not through the rounding of a difference.
    for (const std::vector<Index>& ring : rings)
        for (const Vertex v : ring)
            result[v] = placed[v];
    return result;
}

} // namespace devseg::flatten
