#include "devseg/metrics/circle_maps.h"

#include <cmath>
#include <numeric>

#include <Eigen/LU>

#include "devseg/base/parallel.h"
#include "devseg/flatten/energy/harmonic.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::metrics {

namespace {

using flatten::FlatteningProblem;

// Edges without length get this share of the boundary: their ends must not fall on each other.
constexpr double least_edge = 1e-9;

// The boundary on the unit circle, in proportion to its length; the inside is conformal.
std::vector<Vec2> circle_map(const FlatteningProblem& problem) {
    const double given =
        std::accumulate(problem.boundary_edge.begin(), problem.boundary_edge.end(), 0.0);
    const double added = least_edge * given;
    const double length = given + added * static_cast<double>(problem.boundary.size());
    const double turn = 2.0 * pi / length;
    std::vector<Vec2> uv(at(problem.vertex_count), Vec2::Zero());
    double angle = 0.0;
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        uv[problem.boundary[i]] = Vec2(std::cos(angle), std::sin(angle));
        angle += turn * (problem.boundary_edge[i] + added);
    }
    flatten::HarmonicMap(problem, uv);
    return uv;
}

double stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double flat_area = 0.0;
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Triangle& t = problem.faces[f];
        Eigen::Matrix2d flat;
        flat.col(0) = uv[t[1]] - uv[t[0]];
        flat.col(1) = uv[t[2]] - uv[t[0]];
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
            const FlatteningProblem problem = flatten::make_flattening_problem(mesh, surfaces[c]);
            flatten::expect_no_holes(problem);
            result[c] = stretch(problem, circle_map(problem));
        },
        progress);
    return result;
}

} // namespace devseg::metrics
