// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
//   [Flo03] M. S. Floater: Mean Value Coordinates. Computer Aided Geometric Design 20(1), 2003.
//           doi:10.1016/S0167-8396(03)00002-5
#include "devseg/flatten/maps/lpfb.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

constexpr double closed = 1e-12;       // share of a boundary's length that may be left open
constexpr double rounding = 1e-15;     // and what each edge may add to it
constexpr double smallest_step = 1e-6; // of the line search
// Vertices at mean-value weights at most. On the charts of 22 models, all that this mended had
// fewer; on the others, the boundary is at fault.
constexpr Index most_mended = 32;

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
    const double enough = closed + rounding * static_cast<double>(theta.size());
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
        } while (share > smallest_step &&
                 !(closure.value.norm() < (1.0 - 0.5 * share) * violation));
        if (share <= smallest_step)
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

Vec2 rest_corner(const FlatteningProblem& problem, std::size_t f, std::size_t c) {
    return c == 0 ? Vec2(0.0, 0.0) : Vec2(problem.edges[f].col(c == 1 ? 0 : 1));
}

// Inner vertices in balance between their neighbours, with the boundary where it is.
class Interior {
public:
    Interior(const FlatteningProblem& problem, std::vector<Vec2>& uv) : problem_(problem) {
        slot_.assign(uv.size(), 0);
        for (const Vertex v : problem.boundary)
            slot_[v] = -1;
        for (Index& s : slot_)
            if (s >= 0)
                s = unknowns_++;
        if (unknowns_ > 0)
            balance(uv);
    }

    // Puts the inner vertices of flipped faces at mean-value weights [Flo03]. Rows S of the system
    // A x = b become M x = r. With Z the columns S of A⁻¹, x + Z c meets all other rows for every
    // c, and the new ones for (M Z) c = r − M x. Returns the number of rows, 0 if nothing is done.
    Index mend(std::vector<Vec2>& uv) const {
        std::vector<Index> row(slot_.size(), -1); // #v
        Index count = 0;
        for (const Triangle& t : problem_.faces)
            if (!(orientation(uv[t[0]], uv[t[1]], uv[t[2]]) > 0.0))
                for (const Vertex v : t)
                    if (slot_[v] >= 0 && row[v] < 0)
                        row[v] = count++;
        if (count == 0 || count > most_mended)
            return 0;
        Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(unknowns_, count); // Z
        for (std::size_t v = 0; v < row.size(); ++v)
            if (row[v] >= 0)
                columns(slot_[v], row[v]) = 1.0;
        columns = Eigen::MatrixXd(solver_.solve(columns));
        Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count, count); // M Z
        Eigen::MatrixX2d missing = Eigen::MatrixX2d::Zero(count, 2);  // r − M x
        for (std::size_t f = 0; f < problem_.faces.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vertex v = problem_.faces[f][k];
                if (row[v] < 0)
                    continue;
                const double half =
                    std::tan(0.5 * std::atan2(1.0, problem_.cotangent[f][(k + 1) % 3]));
                for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
                    const Index u = problem_.faces[f][other];
                    const Vec2 edge = rest_corner(problem_, f, other) - rest_corner(problem_, f, k);
                    const double w = half / edge.norm();
                    missing.row(row[v]) += w * (uv[u] - uv[v]).transpose();
                    system.row(row[v]) += w * columns.row(slot_[v]);
                    if (slot_[u] >= 0)
                        system.row(row[v]) -= w * columns.row(slot_[u]);
                }
            }
        const Eigen::MatrixX2d change = columns * system.partialPivLu().solve(missing);
        for (std::size_t v = 0; v < uv.size(); ++v)
            if (slot_[v] >= 0)
                uv[v] += change.row(slot_[v]).transpose();
        return change.allFinite() ? count : 0;
    }

private:
    // The cotangent system; only its lower half is stored.
    void balance(std::vector<Vec2>& uv) {
        Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(unknowns_);
        Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(unknowns_, 2);
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(3 * problem_.faces.size() + at(unknowns_));
        for (std::size_t f = 0; f < problem_.faces.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const double w = problem_.cotangent[f][k];
                const Vertex v = problem_.faces[f][k];
                const Vertex u = problem_.faces[f][(k + 1) % 3];
                const Index i = slot_[v];
                const Index j = slot_[u];
                for (const Index own : {i, j})
                    if (own >= 0)
                        diagonal[own] += w;
                if (i >= 0 && j >= 0)
                    entries.emplace_back(std::max(i, j), std::min(i, j), -w);
                else if (i >= 0 || j >= 0)
                    rhs.row(std::max(i, j)) += w * uv[i >= 0 ? u : v].transpose();
            }
        for (Index i = 0; i < unknowns_; ++i)
            entries.emplace_back(i, i, diagonal[i]);
        Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
        matrix.setFromTriplets(entries.begin(), entries.end());
        solver_.compute(matrix);
        if (solver_.info() == Eigen::Success)
            rhs = Eigen::MatrixX2d(solver_.solve(rhs));
        if (solver_.info() != Eigen::Success || !rhs.allFinite())
            throw NumericalFailure("expected solvable equations for the inside of a chart, found a "
                                   "singular system");
        for (std::size_t v = 0; v < uv.size(); ++v)
            if (slot_[v] >= 0)
                uv[v] = rhs.row(slot_[v]).transpose();
    }

    const FlatteningProblem& problem_;
    std::vector<Index> slot_; // #v: number of the unknown, −1 on the boundary
    Index unknowns_ = 0;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

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
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto corner = [&](std::size_t k) {
                return map.empty() ? rest_corner(problem, f, k) : map[problem.faces[f][k]];
            };
            const Index i = place[problem.faces[f][c]];
            if (i < 0)
                continue;
            const Vec2 p = corner((c + 1) % 3) - corner(c);
            const Vec2 q = corner((c + 2) % 3) - corner(c);
            angles[i] += std::atan2(p.x() * q.y() - p.y() * q.x(), p.dot(q));
        }
    return angles;
}

LpfbResult flatten_lpfb(const FlatteningProblem& problem, const std::vector<double>& targets,
                        const LpfbOptions& options, const Progress& progress) {
    LpfbResult result;
    result.boundary = close_boundary(problem.boundary_edge, targets, options, progress);
    result.uv.assign(at(problem.vertex_count), Vec2::Zero());
    for (std::size_t i = 0; i < problem.boundary.size(); ++i)
        result.uv[problem.boundary[i]] = result.boundary.points[i];
    progress.check();
    const Interior interior(problem, result.uv);
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

} // namespace devseg::flatten
