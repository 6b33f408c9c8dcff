// References
//   B. Lévy, S. Petitjean, N. Ray, J. Maillot: Least Squares Conformal Maps for Automatic Texture
//   Atlas Generation. ACM Transactions on Graphics 21(3), 2002. doi:10.1145/566654.566590
//   The energy is written as Dirichlet energy minus signed area, as in P. Mullen, Y. Tong,
//   P. Alliez, M. Desbrun: Spectral Conformal Parameterization. SGP 2008, equation 4.
#include "devseg/flatten/maps/lscm.h"

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

// Two boundary vertices that are half of the boundary apart: pinning close ones would let the
// rest of the map shrink beside them.
std::pair<Index, Index> pins(const FlatteningProblem& problem) {
    double length = 0.0;
    for (const double l : problem.boundary_edge)
        length += l;
    double walked = 0.0;
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        if (i > 0 && walked >= 0.5 * length)
            return {problem.boundary.front(), problem.boundary[i]};
        walked += problem.boundary_edge[i];
    }
    return {problem.boundary.front(), problem.boundary.back()};
}

} // namespace

std::vector<Vec2> flatten_lscm(const FlatteningProblem& problem) {
    const auto [first, second] = pins(problem);
    // Unknown numbers: vertex v has u at slot[v] and v at slot[v] + 1; pinned ones have none.
    std::vector<Index> slot(at(problem.vertex_count), -1);
    Index unknowns = 0;
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        if (v != first && v != second) {
            slot[v] = unknowns;
            unknowns += 2;
        }
    std::vector<Vec2> uv(at(problem.vertex_count), Vec2::Zero());
    uv[second] = Vec2(std::sqrt(problem.total_area), 0.0);

    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(unknowns);
    const auto couple = [&](Index i, int ci, Index j, int cj, double value) {
        if (slot[i] < 0)
            return;
        if (slot[j] < 0)
            rhs[slot[i] + ci] -= value * uv[j][cj];
        else
            entries.emplace_back(slot[i] + ci, slot[j] + cj, value);
    };
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (Index k = 0; k < 3; ++k) {
            const Index i = problem.faces[f][k];
            const Index j = problem.faces[f][(k + 1) % 3];
            const double w = 0.5 * problem.cotangent[f][k];
            for (int c = 0; c < 2; ++c) {
                couple(i, c, i, c, w);
                couple(j, c, j, c, w);
                couple(i, c, j, c, -w);
                couple(j, c, i, c, -w);
            }
        }
    // The signed area is ½ Σ over boundary edges of u_i v_j − u_j v_i.
    const auto add_area = [&](const std::vector<Index>& ring) {
        for (std::size_t b = 0; b < ring.size(); ++b) {
            const Index i = ring[b];
            const Index j = ring[(b + 1) % ring.size()];
            couple(i, 0, j, 1, -0.5);
            couple(j, 1, i, 0, -0.5);
            couple(j, 0, i, 1, 0.5);
            couple(i, 1, j, 0, 0.5);
        }
    };
    add_area(problem.boundary);
    for (const std::vector<Index>& hole : problem.holes)
        add_area(hole);
    if (unknowns > 0) {
        Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
        matrix.setFromTriplets(entries.begin(), entries.end());
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
        const Eigen::VectorXd solution = solver.solve(rhs);
        if (solver.info() != Eigen::Success || !solution.allFinite())
            throw NumericalFailure("expected a solvable conformal map, found a singular system");
        for (Vertex v = 0; v < problem.vertex_count; ++v)
            if (slot[v] >= 0)
                uv[v] = Vec2(solution[slot[v]], solution[slot[v] + 1]);
    }
    scale_to_area(problem, uv);
    return uv;
}

double conformal_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double energy = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian(problem, uv, f);
        // (σ₁ − σ₂)² = |J|² − 2 det J for positively oriented triangles.
        energy += 0.5 * problem.area[f] * (j.squaredNorm() - 2.0 * j.determinant());
    }
    return energy;
}

} // namespace devseg::flatten
