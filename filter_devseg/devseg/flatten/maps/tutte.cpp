// References
//   W. T. Tutte: How to Draw a Graph. Proceedings of the London Mathematical Society 13, 1963.
//   M. S. Floater: One-to-one Piecewise Linear Mappings over Triangulations. Mathematics of
//   Computation 72, 2003. doi:10.1090/S0025-5718-02-01466-7
#include "devseg/flatten/maps/tutte.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

// Cotangents outside of this range come from angles below 3 or above 177 degrees; as they are, they
// could be negative, and so break the guarantee, or drown all other weights.
constexpr double smallest_weight = 0.05;
constexpr double largest_weight = 20.0;

std::vector<Vec2> place_boundary(const FlatteningProblem& problem) {
    std::vector<Vec2> uv(at(problem.vertex_count), Vec2::Zero());
    double length = 0.0;
    double longest = 0.0;
    for (const double l : problem.boundary_edge) {
        length += l;
        longest = std::max(longest, l);
    }
    // Every edge gets some arc, so that the polygon is strictly convex whatever the lengths.
    const double least = 1e-3 * longest;
    double total = 0.0;
    for (const double l : problem.boundary_edge)
        total += std::max(l, least);
    const double radius = std::sqrt(problem.total_area / pi);
    double walked = 0.0;
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        const double angle = 2.0 * pi * walked / total;
        uv[problem.boundary[i]] = radius * Vec2(std::cos(angle), std::sin(angle));
        walked += std::max(problem.boundary_edge[i], least);
    }
    return uv;
}

template <class Weight>
std::vector<Vec2> balance(const FlatteningProblem& problem, Weight weight) {
    std::vector<Vec2> uv = place_boundary(problem);
    std::vector<Index> slot(at(problem.vertex_count), 0);
    for (const Vertex v : problem.boundary)
        slot[v] = -1;
    Index unknowns = 0;
    for (Index& s : slot)
        if (s >= 0)
            s = unknowns++;
    if (unknowns == 0)
        return uv;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(unknowns, 2);
    const auto pull = [&](Index i, Index j, double w) {
        if (slot[i] < 0)
            return;
        entries.emplace_back(slot[i], slot[i], w);
        if (slot[j] < 0)
            rhs.row(slot[i]) += w * uv[j].transpose();
        else
            entries.emplace_back(slot[i], slot[j], -w);
    };
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (Index k = 0; k < 3; ++k) {
            const Index i = problem.faces[f][k];
            const Index j = problem.faces[f][(k + 1) % 3];
            const double w = weight(problem.cotangent[f][k]);
            pull(i, j, w);
            pull(j, i, w);
        }
    Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::MatrixX2d solution = solver.solve(rhs);
    if (solver.info() != Eigen::Success || !solution.allFinite())
        throw NumericalFailure("expected a solvable Tutte embedding, found a singular system");
    for (std::size_t v = 0; v < slot.size(); ++v)
        if (slot[v] >= 0)
            uv[v] = solution.row(slot[v]).transpose();
    return uv;
}

} // namespace

std::vector<Vec2> flatten_tutte(const FlatteningProblem& problem) {
    std::vector<Vec2> uv = balance(problem, [](double cotangent) {
        return std::clamp(cotangent, smallest_weight, largest_weight);
    });
    if (count_flips(problem, uv) > 0)
        uv = balance(problem, [](double) { return 1.0; });
    scale_to_area(problem, uv);
    return uv;
}

} // namespace devseg::flatten
