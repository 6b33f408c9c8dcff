#include "devseg/flatten/energy/laplacian.h"

#include <algorithm>

#include "devseg/base/errors.h"

namespace devseg::flatten {

namespace {

constexpr double immovable = 1e20; // stiffness of vertices that stay: their steps vanish

} // namespace

Laplacian::Laplacian(const FlatteningProblem& problem, const std::vector<std::uint8_t>& fixed) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(9 * problem.faces.size() + at(problem.vertex_count));
    const double scale = 0.5 / problem.total_area;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (Index k = 0; k < 3; ++k) {
            const Index i = problem.faces[f][k];
            const Index j = problem.faces[f][(k + 1) % 3];
            const double w = scale * problem.cotangent[f][k];
            entries.emplace_back(i, i, w);
            entries.emplace_back(j, j, w);
            entries.emplace_back(std::max(i, j), std::min(i, j), -w); // the lower half counts
        }
    double shift = 1e-8 / problem.total_area;
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        entries.emplace_back(v, v, fixed.empty() || fixed[v] == 0 ? shift : immovable);
    Eigen::SparseMatrix<double> matrix(problem.vertex_count, problem.vertex_count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
    // The cotangents of needles swallow the shift.
    for (; solver_.info() != Eigen::Success && shift < immovable; shift *= 1e3) {
        matrix.diagonal().array() += shift;
        solver_.factorize(matrix);
    }
    if (solver_.info() != Eigen::Success)
        throw NumericalFailure("expected a positive definite Laplacian, found a singular one");
}

// Eigen reads the factor anew for each column; here it is read once for both.
Positions Laplacian::solve(const Positions& rhs) const {
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

} // namespace devseg::flatten
