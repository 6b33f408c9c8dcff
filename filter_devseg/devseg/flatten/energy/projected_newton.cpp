#include "devseg/flatten/energy/projected_newton.h"

#include <algorithm>
#include <utility>

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"

namespace devseg::flatten {

namespace {
// Rigid motions do not change the energy: this share of the mean diagonal keeps H definite.
constexpr double shift_share = 1e-10;
constexpr double locked = 1e10; // of the mean diagonal: the step of a vertex that stays vanishes

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

} // namespace

struct ProjectedNewton::State {
    const FlatteningProblem& problem;
    std::vector<std::uint8_t> fixed;
    AreaCurvature area_curvature;
    double boundary_stiffness = 0.0;
    HessianMatrix hessian;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
};

ProjectedNewton::ProjectedNewton(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed,
                                 AreaCurvature area_curvature, double boundary_stiffness)
    : state_(new State{
          problem, std::move(fixed), std::move(area_curvature), boundary_stiffness, {}, {}}) {}
ProjectedNewton::~ProjectedNewton() = default;

Positions ProjectedNewton::direction(const Positions& x, const Positions& gradient) {
    const FlatteningProblem& problem = state_->problem;
    HessianMatrix& hessian = state_->hessian;
    const Index unknowns = 2 * problem.vertex_count;
    hessian.begin(unknowns);
    double trace = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        // J's columns are linear in the corners: ∂(J column c)/∂ corner k = weight(k, c) ·
        // identity.
        const Eigen::Matrix2d& inverse = problem.inverse[f];
        Eigen::Matrix<double, 3, 2> weight;
        weight.row(1) = inverse.row(0);
        weight.row(2) = inverse.row(1);
        weight.row(0) = -inverse.row(0) - inverse.row(1);
        const Eigen::Matrix2d map = jacobian(problem, x, f);
        Eigen::Matrix4d h = projected_hessian(map);
        if (state_->area_curvature) {
            const Eigen::Vector4d cofactor(map(1, 1), -map(0, 1), -map(1, 0),
                                           map(0, 0)); // ∂ det / ∂ J
            h += state_->area_curvature(f, map.determinant()) * cofactor * cofactor.transpose();
        }
        h *= problem.area[f] / problem.total_area;
        const Triangle& t = problem.faces[f];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const Vertex v = t[static_cast<std::size_t>(i)];
                const Index u = t[static_cast<std::size_t>(j)];
                if (v < u)
                    continue;
                Eigen::Matrix2d block = Eigen::Matrix2d::Zero();
                for (int c = 0; c < 2; ++c)
                    for (int d = 0; d < 2; ++d)
                        block += weight(i, c) * weight(j, d) * h.block<2, 2>(2 * c, 2 * d);
                for (int r = 0; r < 2; ++r)
                    for (int s = 0; s < 2; ++s)
                        hessian.add(2 * v + r, 2 * u + s, block(r, s));
                if (i == j)
                    trace += block.trace();
            }
    }
    for (std::size_t i = 0; i < problem.boundary.size() && state_->boundary_stiffness > 0.0; ++i) {
        const Vertex v = problem.boundary[i];
        const Index u = problem.boundary[(i + 1) % problem.boundary.size()];
        const Eigen::RowVector2d along = (x.row(u) - x.row(v)).stableNormalized();
        // Without the part that turns the edge: it may be negative.
        const Eigen::Matrix2d block =
            2.0 * state_->boundary_stiffness / problem.total_area * along.transpose() * along;
        for (int r = 0; r < 2; ++r)
            for (int s = 0; s < 2; ++s) {
                hessian.add(2 * v + r, 2 * v + s, block(r, s));
                hessian.add(2 * u + r, 2 * u + s, block(r, s));
                hessian.add(2 * v + r, 2 * u + s, -block(r, s));
                hessian.add(2 * u + r, 2 * v + s, -block(r, s));
            }
    }
    for (Index i = 0; i < unknowns; ++i) {
        const bool stays = !state_->fixed.empty() && state_->fixed[i / 2] != 0;
        hessian.add(i, i, (stays ? locked : shift_share) * trace / unknowns);
    }
    if (hessian.finish())
        state_->solver.analyzePattern(hessian.matrix);
    state_->solver.factorize(hessian.matrix);
    Eigen::VectorXd rhs(unknowns);
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        rhs.segment<2>(2 * v) = -gradient.row(v).transpose();
    const Eigen::VectorXd solution = state_->solver.solve(rhs);
    if (state_->solver.info() != Eigen::Success || !solution.allFinite())
        throw NumericalFailure("expected a positive definite Hessian, found a singular one");
    Positions d(problem.vertex_count, 2);
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        d.row(v) = solution.segment<2>(2 * v).transpose();
    return d;
}

} // namespace devseg::flatten
