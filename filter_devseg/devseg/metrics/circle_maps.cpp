#include "devseg/metrics/circle_maps.h"

#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::metrics {

namespace {

using Positions = Eigen::MatrixX2d;

// Edges without length get this share of the boundary: their ends must not fall on each other.
constexpr double least_edge = 1e-9;

// The boundary on the unit circle, in proportion to its length; rows of inner vertices are zero.
Positions circle_positions(const flatten::FlatteningProblem& problem) {
    const double given =
        std::accumulate(problem.boundary_edge.begin(), problem.boundary_edge.end(), 0.0);
    const double added = least_edge * given;
    const double length = given + added * static_cast<double>(problem.boundary.size());
    const double turn = 2.0 * pi / length;
    Positions positions = Positions::Zero(problem.vertex_count, 2);
    double angle = 0.0;
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        positions.row(problem.boundary[i]) << std::cos(angle), std::sin(angle);
        angle += turn * (problem.boundary_edge[i] + added);
    }
    return positions;
}

// Inner vertices first: numbers of all vertices in the order of the unknowns.
std::vector<Index> unknowns_first(const flatten::FlatteningProblem& problem, Index& unknowns) {
    std::vector<Index> number(at(problem.vertex_count), 0);
    for (const Vertex v : problem.boundary)
        number[v] = -1;
    unknowns = 0;
    for (Index& n : number)
        n = n < 0 ? n : unknowns++;
    return number;
}

Positions conformal_positions(const flatten::FlatteningProblem& problem) {
    Positions positions = circle_positions(problem);
    Index unknowns = 0;
    const std::vector<Index> number = unknowns_first(problem, unknowns);
    if (unknowns == 0)
        return positions;
    std::vector<Eigen::Triplet<double>> entries;
    Positions right = Positions::Zero(unknowns, 2);
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const double weight = problem.cotangent[f][k];
            const Index ends[2] = {problem.faces[f][k], problem.faces[f][(k + 1) % 3]};
            for (int side = 0; side < 2; ++side) {
                const Index row = number[ends[side]];
                const Index column = number[ends[1 - side]];
                if (row < 0)
                    continue;
                entries.emplace_back(row, row, weight);
                if (column < 0)
                    right.row(row) += weight * positions.row(ends[1 - side]);
                else
                    entries.emplace_back(row, column, -weight);
            }
        }
    Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(laplacian);
    const Positions inner = factors.solve(right);
    if (factors.info() != Eigen::Success || !inner.allFinite())
        throw NumericalFailure("expected a chart with a conformal map to the circle, found a "
                               "singular system; repair faces without area first");
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        if (number[v] >= 0)
            positions.row(v) = inner.row(number[v]);
    return positions;
}

double stretch(const flatten::FlatteningProblem& problem, const Positions& positions) {
    double flat_area = 0.0;
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Triangle& t = problem.faces[f];
        Eigen::Matrix2d flat;
        flat.col(0) = (positions.row(t[1]) - positions.row(t[0])).transpose();
        flat.col(1) = (positions.row(t[2]) - positions.row(t[0])).transpose();
        flat_area += 0.5 * std::abs(flat.determinant());
        // (Γ² + γ²) / 2 of the map from the disc to the surface.
        const double face = (problem.edges[f] * flat.inverse()).squaredNorm();
        // Without area in the plane, the inverse is infinite in one direction and no number in
        // the other.
        sum += std::isfinite(face) ? problem.area[f] * 0.5 * face : infinite;
    }
    return std::sqrt(sum / problem.total_area * (flat_area / problem.total_area));
}

} // namespace

std::vector<double> circle_map_stretch(const Mesh& mesh, const atlas::ChartMap& charts,
                                       Progress& progress) {
    const std::vector<atlas::ChartSurface> surfaces = atlas::extract_charts(mesh, charts);
    std::vector<double> result(surfaces.size(), 0.0);
    parallel_for(
        static_cast<int>(surfaces.size()),
        [&](int c) {
            const flatten::FlatteningProblem problem =
                flatten::make_flattening_problem(mesh, surfaces[c]);
            result[c] = stretch(problem, conformal_positions(problem));
        },
        progress);
    return result;
}

} // namespace devseg::metrics
