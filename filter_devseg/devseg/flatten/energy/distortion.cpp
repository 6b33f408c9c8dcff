// References
//   J. Smith, S. Schaefer: Bijective Parameterization with Free Boundaries. ACM Transactions on
//   Graphics 34(4), 2015. doi:10.1145/2766947 (the energy; the step bound of section 3.3)
//   [SGK19] B. Smith, F. de Goes, T. Kim: Analytic Eigensystems for Isotropic Distortion Energies.
//   ACM Transactions on Graphics 38(1), 2019. doi:10.1145/3241041
#include "devseg/flatten/energy/distortion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <Eigen/SparseCore>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/block_cholesky.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    double sufficient_decrease = 1e-4; // Armijo's constant
    double safe_step = 0.8;            // share of the step at which the first triangle collapses
    double farthest_step =
        1.3; // of the first triangle's collapse that matters: safe_step of it > 1
    double smallest_step = 1e-12;
    // Rigid motions do not change the energy: this share of the mean diagonal keeps H definite.
    double shift_share = 1e-10;
    double shift_growth = 30.0;
    double largest_shift = 1e-6;
    double locked_share = 1e10; // of the mean diagonal: the step of a vertex that stays vanishes
};
constexpr Tuning tuning;

// Smallest t > 0 with a t² + b t + c = 0; infinite if there is none. c > 0.
double first_root(double a, double b, double c) {
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0)
        return infinite;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    double best = infinite;
    for (const double root : {a != 0.0 ? q / a : infinite, q != 0.0 ? c / q : infinite})
        if (root > 0.0)
            best = std::min(best, root);
    return best;
}

// The lower half of H. The places of its entries are found once; then only values change.
class HessianMatrix {
public:
    void begin(Index unknowns) {
        if (matrix.nonZeros() > 0)
            Eigen::Map<Eigen::VectorXd>(matrix.valuePtr(), matrix.nonZeros()).setZero();
        else
            matrix.resize(unknowns, unknowns);
        next_ = 0;
    }
    void add(Index row, Index column, double value) {
        if (row < column)
            return;
        if (place_.empty())
            entries_.emplace_back(row, column, value);
        else
            matrix.valuePtr()[place_[next_++]] += value;
    }
    /// Whether the places were found now.
    bool finish() {
        if (!place_.empty())
            return false;
        matrix.setFromTriplets(entries_.begin(), entries_.end());
        for (const auto& entry : entries_) {
            const int* const begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[entry.col()];
            const int* const end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[entry.col() + 1];
            place_.push_back(std::lower_bound(begin, end, entry.row()) - matrix.innerIndexPtr());
        }
        entries_ = {};
        return true;
    }

    Eigen::SparseMatrix<double> matrix;

private:
    std::vector<Eigen::Triplet<double>> entries_;
    std::vector<std::ptrdiff_t> place_; // of each entry, in the order in which they are added
    std::size_t next_ = 0;
};

// Stiff boundary edges, without the part that turns them: it may be negative.
void add_boundary(const FlatteningProblem& problem, double stiffness,
                  const std::vector<Eigen::Matrix2d>& blocks, const Positions& x,
                  HessianMatrix& hessian) {
    for (const Vertex v : problem.boundary)
        for (int r = 0; r < 2; ++r)
            for (int s = 0; s < 2; ++s) // without blocks as well: the places stay the same
                hessian.add(2 * v + r, 2 * v + s, blocks.empty() ? 0.0 : blocks[v](r, s));
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        const Vertex v = problem.boundary[i];
        const Vertex u = problem.boundary[(i + 1) % problem.boundary.size()];
        const Eigen::RowVector2d along = (x.row(u) - x.row(v)).stableNormalized();
        const Eigen::Matrix2d block =
            2.0 * stiffness / problem.total_area * along.transpose() * along;
        for (int r = 0; r < 2; ++r)
            for (int s = 0; s < 2; ++s) {
                hessian.add(2 * v + r, 2 * v + s, block(r, s));
                hessian.add(2 * u + r, 2 * u + s, block(r, s));
                hessian.add(2 * v + r, 2 * u + s, -block(r, s));
                hessian.add(2 * u + r, 2 * v + s, -block(r, s));
            }
    }
}

} // namespace

Positions positions_of(const std::vector<Vec2>& uv) {
    Positions x(static_cast<Eigen::Index>(uv.size()), 2);
    for (std::size_t v = 0; v < uv.size(); ++v)
        x.row(static_cast<Eigen::Index>(v)) = uv[v].transpose();
    return x;
}

std::vector<Vec2> points_of(const Positions& x) {
    std::vector<Vec2> uv;
    for (Eigen::Index v = 0; v < x.rows(); ++v)
        uv.emplace_back(x.row(v).transpose());
    return uv;
}

void hold_fixed(const std::vector<std::uint8_t>& fixed, Positions& rows) {
    for (std::size_t v = 0; v < fixed.size(); ++v)
        if (fixed[v] != 0)
            rows.row(static_cast<Eigen::Index>(v)).setZero();
}

namespace {

// The Jacobian of a face as plain numbers: descents spend half of their time here, and small
// matrices that are read row by row from columns take several times as long.
struct FaceMap {
    FaceMap(const FlatteningProblem& problem, const Positions& x, std::size_t f) {
        const Triangle& t = problem.faces[f];
        const double* const u = x.data();
        const double* const v = u + x.rows();
        const double u1 = u[t[1]] - u[t[0]];
        const double v1 = v[t[1]] - v[t[0]];
        const double u2 = u[t[2]] - u[t[0]];
        const double v2 = v[t[2]] - v[t[0]];
        const double* const inverse = problem.inverse[f].data(); // column by column
        a = u1 * inverse[0] + u2 * inverse[1];
        b = v1 * inverse[0] + v2 * inverse[1];
        c = u1 * inverse[2] + u2 * inverse[3];
        d = v1 * inverse[2] + v2 * inverse[3];
        det = a * d - b * c;
        squared = (a * a + c * c) + (b * b + d * d);
    }

    // 4 A ψ with the density ψ = (|J|² + |J⁻¹|²) / 4, and |J⁻¹|² = |J|² / det² in the plane.
    double energy(double area) const { return area * squared * (1.0 + 1.0 / (det * det)); }

    double a, b, c, d; // column by column
    double det;
    double squared; // |J|²
};

// ∂ψ/∂J = along · J − across · ∂det/∂J, but for the half that both have.
struct Stress {
    explicit Stress(const FaceMap& j) {
        const double along = 1.0 + 1.0 / (j.det * j.det);
        const double across = j.squared / (j.det * j.det * j.det);
        a = 0.5 * (along * j.a - across * j.d);
        b = 0.5 * (along * j.b - across * -j.c);
        c = 0.5 * (along * j.c - across * -j.b);
        d = 0.5 * (along * j.d - across * j.a);
    }

    double a, b, c, d; // column by column
};

// Adds what face f, with this Jacobian, pulls at its corners.
inline void add_force(const FlatteningProblem& problem, std::size_t f, const FaceMap& j,
                      Positions& gradient) {
    const Stress stress(j);
    const double weight = problem.area[f] / problem.total_area;
    const double* const inverse = problem.inverse[f].data();
    const double a = weight * stress.a;
    const double b = weight * stress.b;
    const double c = weight * stress.c;
    const double d = weight * stress.d;
    const double u1 = a * inverse[0] + c * inverse[2];
    const double v1 = b * inverse[0] + d * inverse[2];
    const double u2 = a * inverse[1] + c * inverse[3];
    const double v2 = b * inverse[1] + d * inverse[3];
    const Triangle& t = problem.faces[f];
    double* const u = gradient.data();
    double* const v = u + gradient.rows();
    u[t[1]] += u1;
    v[t[1]] += v1;
    u[t[2]] += u2;
    v[t[2]] += v2;
    u[t[0]] -= u1 + u2;
    v[t[0]] -= v1 + v2;
}

} // namespace

double distortion(const FlatteningProblem& problem, const Positions& x) {
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const FaceMap j(problem, x, f);
        if (!(j.det > 0.0))
            return infinite;
        sum += j.energy(problem.area[f]);
    }
    return sum / (4.0 * problem.total_area);
}

Eigen::Vector4d density_gradient(const Eigen::Matrix2d& j) {
    const double det = j.determinant();
    Eigen::Matrix2d cofactor; // ∂ det / ∂ J
    cofactor << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);
    const Eigen::Matrix2d stress =
        0.5 * ((1.0 + 1.0 / (det * det)) * j - (j.squaredNorm() / (det * det * det)) * cofactor);
    return {stress(0, 0), stress(1, 0), stress(0, 1), stress(1, 1)};
}

Positions distortion_gradient(const FlatteningProblem& problem, const Positions& x) {
    Positions gradient = Positions::Zero(x.rows(), 2);
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        add_force(problem, f, FaceMap(problem, x, f), gradient);
    return gradient;
}

double distortion_with_gradient(const FlatteningProblem& problem, const Positions& x,
                                Positions& gradient) {
    gradient.setZero(x.rows(), 2);
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const FaceMap j(problem, x, f);
        if (!(j.det > 0.0))
            return infinite;
        sum += j.energy(problem.area[f]);
        add_force(problem, f, j, gradient);
    }
    return sum / (4.0 * problem.total_area);
}

// J = U Σ Vᵀ with rotations U and V of φ and −θ: what the modes of [SGK19, section 4] need of them
// are R(φ + θ) and R(φ − θ), which come from the parts of J that turn and that mirror.
Eigen::Matrix4d projected_hessian(const Eigen::Matrix2d& j) {
    const double turn_c = 0.5 * (j(0, 0) + j(1, 1));
    const double turn_s = 0.5 * (j(1, 0) - j(0, 1));
    const double mirror_c = 0.5 * (j(0, 0) - j(1, 1));
    const double mirror_s = 0.5 * (j(1, 0) + j(0, 1));
    const double turned = std::hypot(turn_c, turn_s);
    const double mirrored = std::hypot(mirror_c, mirror_s);
    const double s1 = turned + mirrored;
    const double s2 = turned - mirrored;
    const double c2 = turn_c / turned;
    const double n2 = turn_s / turned;
    const double c1 = mirrored > 0.0 ? mirror_c / mirrored : 1.0; // any for s1 = s2
    const double n1 = mirrored > 0.0 ? mirror_s / mirrored : 0.0;
    const double cube1 = s1 * s1 * s1;
    const double cube2 = s2 * s2 * s2;
    // Two scaling modes, the twist and the flip, column by column.
    const double half = std::sqrt(0.5);
    const std::array<double, 4> eigenvalue{
        0.5 * (1.0 + 3.0 / (cube1 * s1)), 0.5 * (1.0 + 3.0 / (cube2 * s2)),
        std::max(0.0, 0.5 * (s1 + s2 - 1.0 / cube1 - 1.0 / cube2) / (s1 + s2)),
        0.5 * (1.0 + (s1 * s1 + s1 * s2 + s2 * s2) / (cube1 * cube2))};
    const std::array<std::array<double, 4>, 4> mode{
        {{0.5 * (c2 + c1), 0.5 * (n2 + n1), 0.5 * (n1 - n2), 0.5 * (c2 - c1)},
         {0.5 * (c2 - c1), 0.5 * (n2 - n1), -0.5 * (n1 + n2), 0.5 * (c2 + c1)},
         {-half * n2, half * c2, -half * c2, -half * n2},
         {-half * n1, half * c1, half * c1, half * n1}}};
    Eigen::Matrix4d hessian;
    for (std::size_t column = 0; column < 4; ++column)
        for (std::size_t row = 0; row < 4; ++row) {
            double sum = 0.0;
            for (std::size_t k = 0; k < 4; ++k)
                sum += eigenvalue[k] * mode[k][row] * mode[k][column];
            hessian(static_cast<int>(row), static_cast<int>(column)) = sum;
        }
    return hessian;
}

double collapse_step(const FlatteningProblem& problem, const Positions& x, const Positions& d,
                     double limit) {
    double step = infinite;
    const double* const u = x.data();
    const double* const v = u + x.rows();
    const double* const du = d.data();
    const double* const dv = du + d.rows();
    for (const Triangle& t : problem.faces) {
        const Vec2 p(u[t[1]] - u[t[0]], v[t[1]] - v[t[0]]);
        const Vec2 q(u[t[2]] - u[t[0]], v[t[2]] - v[t[0]]);
        const Vec2 dp(du[t[1]] - du[t[0]], dv[t[1]] - dv[t[0]]);
        const Vec2 dq(du[t[2]] - du[t[0]], dv[t[2]] - dv[t[0]]);
        const double a = plane::cross(dp, dq);
        const double b = plane::cross(p, dq) + plane::cross(dp, q);
        const double c = plane::cross(p, q);
        // Most triangles keep an area up to the limit whatever the signs of a and b.
        if (!(c > limit * (std::abs(b) + limit * std::abs(a))))
            step = std::min(step, first_root(a, b, c));
    }
    return step;
}

bool line_search(const FlatteningProblem& problem,
                 const std::function<double(const Positions&)>& value, const Positions& d,
                 double slope, Positions& x, double& energy) {
    if (!(slope < 0.0))
        return false;
    double step =
        std::min(1.0, tuning.safe_step * collapse_step(problem, x, d, tuning.farthest_step));
    for (; step > tuning.smallest_step; step *= 0.5) {
        Positions next = x + step * d;
        const double next_energy = value(next);
        if (next_energy > energy + tuning.sufficient_decrease * step * slope)
            continue;
        if (!(next_energy < energy))
            return false;
        x = std::move(next);
        energy = next_energy;
        return true;
    }
    return false;
}

namespace {

// A stiff boundary rounds more off than the usual shift is: then shifts grow until they outweigh
// it.
void factorize_shifted(Eigen::SparseMatrix<double>& matrix, BlockCholesky& solver) {
    if (solver.factorize(matrix))
        return;
    const double mean = matrix.diagonal().mean();
    for (double share = tuning.shift_share; share <= tuning.largest_shift;
         share *= tuning.shift_growth) {
        for (Eigen::Index i = 0; i < matrix.rows(); ++i)
            matrix.coeffRef(i, i) += share * mean;
        if (solver.factorize(matrix))
            return;
    }
    throw NumericalFailure("expected a positive definite Hessian, found one that is not");
}

} // namespace

struct ProjectedNewton::State {
    const FlatteningProblem& problem;
    std::vector<std::uint8_t> fixed;
    FaceHessian face_hessian;
    double boundary_stiffness = 0.0;
    std::vector<Eigen::Matrix2d> boundary_blocks; // #v, or empty
    HessianMatrix hessian;
    BlockCholesky solver;
};

ProjectedNewton::ProjectedNewton(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed,
                                 FaceHessian face_hessian, double boundary_stiffness)
    : state_(new State{
          problem, std::move(fixed), std::move(face_hessian), boundary_stiffness, {}, {}, {}}) {}
ProjectedNewton::~ProjectedNewton() = default;

void ProjectedNewton::set_boundary_stiffness(double stiffness) {
    state_->boundary_stiffness = stiffness;
}

void ProjectedNewton::set_boundary_blocks(std::vector<Eigen::Matrix2d> blocks) {
    state_->boundary_blocks = std::move(blocks);
}

Positions ProjectedNewton::direction(const Positions& x, const Positions& gradient) {
    const FlatteningProblem& problem = state_->problem;
    HessianMatrix& hessian = state_->hessian;
    const Index unknowns = 2 * problem.vertex_count;
    hessian.begin(unknowns);
    double trace = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        // J's columns are linear in the corners: ∂(J column c)/∂ corner k = weight(k, c) ·
        // identity.
        const double* const inverse = problem.inverse[f].data(); // column by column
        const double weight[3][2] = {{-inverse[0] - inverse[1], -inverse[2] - inverse[3]},
                                     {inverse[0], inverse[2]},
                                     {inverse[1], inverse[3]}};
        const Eigen::Matrix2d map = jacobian(problem, x, f);
        Eigen::Matrix4d h =
            state_->face_hessian ? state_->face_hessian(f, map) : projected_hessian(map);
        h *= problem.area[f] / problem.total_area;
        const Triangle& t = problem.faces[f];
        for (int j = 0; j < 3; ++j) {
            // Columns of h for corner j: rows 2 c + r, columns s.
            double at_corner[2][4];
            for (int s = 0; s < 2; ++s)
                for (int row = 0; row < 4; ++row)
                    at_corner[s][row] = weight[j][0] * h(row, s) + weight[j][1] * h(row, 2 + s);
            for (int i = 0; i < 3; ++i) {
                const Index v = t[static_cast<std::size_t>(i)];
                const Index u = t[static_cast<std::size_t>(j)];
                if (v < u)
                    continue;
                for (int r = 0; r < 2; ++r)
                    for (int s = 0; s < 2; ++s) {
                        const double value =
                            weight[i][0] * at_corner[s][r] + weight[i][1] * at_corner[s][2 + r];
                        hessian.add(2 * v + r, 2 * u + s, value);
                        trace += i == j && r == s ? value : 0.0;
                    }
            }
        }
    }
    if (state_->boundary_stiffness > 0.0)
        add_boundary(problem, state_->boundary_stiffness, state_->boundary_blocks, x, hessian);
    for (Index i = 0; i < unknowns; ++i) {
        const bool stays = !state_->fixed.empty() && state_->fixed[i / 2] != 0;
        hessian.add(i, i, (stays ? tuning.locked_share : tuning.shift_share) * trace / unknowns);
    }
    if (hessian.finish())
        state_->solver.analyze(hessian.matrix);
    factorize_shifted(hessian.matrix, state_->solver);
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>; // x, y, x, y …
    const Rows descent = -gradient;
    const Eigen::Map<const Eigen::VectorXd> rhs(descent.data(), unknowns);
    const Eigen::VectorXd solution = state_->solver.solve(rhs);
    if (!solution.allFinite())
        throw NumericalFailure("expected a positive definite Hessian, found a singular one");
    return Eigen::Map<const Rows>(solution.data(), problem.vertex_count, 2);
}

} // namespace devseg::flatten
