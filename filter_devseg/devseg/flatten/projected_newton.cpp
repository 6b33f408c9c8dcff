#include "devseg/flatten/projected_newton.h"

#include <utility>

#include <Eigen/SparseCholesky>

#include "devseg/errors.h"

namespace devseg {

namespace {
// Rigid motions do not change the energy: this share of the mean diagonal keeps H definite.
constexpr double shift_share = 1e-10;
constexpr double locked = 1e10; // of the mean diagonal: the step of a vertex that stays vanishes
} // namespace

struct ProjectedNewton::State {
    const FlatteningProblem& problem;
    std::vector<std::uint8_t> fixed;
    std::function<double(double)> area_curvature;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
    std::vector<Eigen::Triplet<double>> entries;
    bool analyzed = false;
};

ProjectedNewton::ProjectedNewton(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed,
                                 std::function<double(double)> area_curvature)
    : state_(new State{problem, std::move(fixed), std::move(area_curvature), {}, {}, false}) {}
ProjectedNewton::~ProjectedNewton() = default;

Positions ProjectedNewton::direction(const Positions& x, const Positions& gradient) {
    const FlatteningProblem& problem = state_->problem;
    std::vector<Eigen::Triplet<double>>& entries = state_->entries;
    entries.clear();
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
            h += state_->area_curvature(map.determinant()) * cofactor * cofactor.transpose();
        }
        h *= problem.area[f] / problem.total_area;
        const Triangle& t = problem.faces[f];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                Eigen::Matrix2d block = Eigen::Matrix2d::Zero();
                for (int c = 0; c < 2; ++c)
                    for (int d = 0; d < 2; ++d)
                        block += weight(i, c) * weight(j, d) * h.block<2, 2>(2 * c, 2 * d);
                for (int r = 0; r < 2; ++r)
                    for (int s = 0; s < 2; ++s)
                        entries.emplace_back(2 * t[static_cast<std::size_t>(i)] + r,
                                             2 * t[static_cast<std::size_t>(j)] + s, block(r, s));
                if (i == j)
                    trace += block.trace();
            }
    }
    const Index unknowns = 2 * problem.vertex_count;
    for (Index i = 0; i < unknowns; ++i) {
        const bool stays = !state_->fixed.empty() && state_->fixed[at(i / 2)] != 0;
        entries.emplace_back(i, i, (stays ? locked : shift_share) * trace / unknowns);
    }
    Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (!state_->analyzed)
        state_->solver.analyzePattern(matrix);
    state_->analyzed = true;
    state_->solver.factorize(matrix);
    Eigen::VectorXd rhs(unknowns);
    for (Index v = 0; v < problem.vertex_count; ++v)
        rhs.segment<2>(2 * v) = -gradient.row(v).transpose();
    const Eigen::VectorXd solution = state_->solver.solve(rhs);
    if (state_->solver.info() != Eigen::Success || !solution.allFinite())
        throw NumericalFailure("expected a positive definite Hessian, found a singular one");
    Positions d(problem.vertex_count, 2);
    for (Index v = 0; v < problem.vertex_count; ++v)
        d.row(v) = solution.segment<2>(2 * v).transpose();
    return d;
}

} // namespace devseg
