// References
//   N. Sharp, K. Crane: A Laplacian for Nonmanifold Triangle Meshes. Computer Graphics Forum 39(5),
//   2020, section 4.5 (intrinsic mollification). doi:10.1111/cgf.14069
#include "devseg/flatten/energy/rest_shape.h"

#include <algorithm>
#include <cmath>

#include "devseg/atlas/holes.h"
#include "devseg/base/errors.h"

namespace devseg::flatten {

namespace {

// A triangle is solid when each two sides are longer than the third by this share of the longest:
// heights of about 1e-4 of the length, which the coordinates of hosts (32 bit) can still express.
constexpr double solid_margin = 1e-9;

std::array<double, 3> solid_lengths(std::array<double, 3> length, double floor) {
    const double longest = std::max({length[0], length[1], length[2], floor});
    double missing = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double slack = length[(i + 1) % 3] + length[(i + 2) % 3] - length[i];
        missing = std::max(missing, solid_margin * longest - slack);
    }
    for (double& l : length)
        l += missing;
    return length;
}

} // namespace

RestTriangle make_rest_triangle(std::array<double, 3> length, double floor) {
    length = solid_lengths(length, floor);
    const double a = length[0]; // 0 → 1
    const double b = length[1]; // 1 → 2
    const double c = length[2]; // 2 → 0
    const double x = (a * a + c * c - b * b) / (2.0 * a);
    // Kahan's formula: Heron's loses all digits on needles.
    std::array<double, 3> sorted = length;
    std::sort(sorted.begin(), sorted.end());
    const double p = sorted[2];
    const double q = sorted[1];
    const double r = sorted[0];
    RestTriangle triangle;
    const double area =
        0.25 *
        std::sqrt(std::max(0.0, (p + (q + r)) * (r - (p - q)) * (r + (p - q)) * (p + (q - r))));
    triangle.area = area;
    triangle.edges << a, x, 0.0, 2.0 * area / a;
    triangle.cotangent = {(b * b + c * c - a * a) / (4.0 * area),
                          (c * c + a * a - b * b) / (4.0 * area),
                          (a * a + b * b - c * c) / (4.0 * area)};
    return triangle;
}

FlatteningProblem make_flattening_problem(const Mesh& mesh, const atlas::ChartSurface& surface) {
    const auto is_hole = atlas::sound_holes(mesh, surface);
    if (!is_hole)
        throw NumericalFailure("expected a chart that is a disk, or one with flat holes, found one "
                               "with " +
                               std::to_string(surface.loops.size()) +
                               " boundary loops; apply 'Charts: Cut to Disks' first");
    FlatteningProblem problem;
    problem.vertex_count = surface.vertex_count();
    problem.faces = surface.faces;
    problem.twin = surface.twin;
    problem.model_size = std::sqrt(mesh.model_area());
    for (std::size_t l = 0; l < surface.loops.size(); ++l) {
        std::vector<Index>& ring =
            (*is_hole)[l] != 0 ? problem.holes.emplace_back() : problem.boundary;
        for (const HalfEdge h : surface.loops[l]) {
            ring.push_back(surface.origin(h));
            if ((*is_hole)[l] == 0)
                problem.boundary_edge.push_back(mesh.edge_length(surface.mesh_half_edge(h)));
        }
    }
    double longest = 0.0;
    for (const HalfEdge h : surface.all_half_edges())
        longest = std::max(longest, mesh.edge_length(surface.mesh_half_edge(h)));
    // Faces whose corners coincide get a size as well: a billionth of the chart's longest edge, and
    // one whose fourth power does not vanish where the chart is a point.
    const double floor = std::max(1e-9 * longest, 1e-60 * problem.model_size);
    problem.edges.reserve(surface.faces.size());
    problem.inverse.reserve(surface.faces.size());
    problem.area.reserve(surface.faces.size());
    problem.given_area.reserve(surface.faces.size());
    problem.cotangent.reserve(surface.faces.size());
    for (const Face f : surface.all_faces()) {
        std::array<double, 3> length{};
        for (const HalfEdge h : half_edges_of(f))
            length[corner_of(h)] = mesh.edge_length(surface.mesh_half_edge(h));
        const RestTriangle triangle = make_rest_triangle(length, floor);
        const Eigen::Matrix2d& e = triangle.edges;
        Eigen::Matrix2d inverse;
        inverse << 1.0 / e(0, 0), -e(0, 1) / (e(0, 0) * e(1, 1)), 0.0, 1.0 / e(1, 1);
        problem.edges.push_back(e);
        problem.inverse.push_back(inverse);
        problem.area.push_back(triangle.area);
        problem.given_area.push_back(mesh.face_areas[surface.face[f]]);
        problem.total_area += triangle.area;
        problem.cotangent.push_back(triangle.cotangent);
    }
    return problem;
}

PartialProblem part_of(const FlatteningProblem& whole, const std::vector<Index>& faces) {
    PartialProblem part;
    FlatteningProblem& problem = part.problem;
    std::vector<std::uint8_t> inside(whole.faces.size(), 0);
    std::vector<Index> number(at(whole.vertex_count), -1);
    for (const Face f : faces) {
        inside[f] = 1;
        Triangle t = whole.faces[f];
        for (Index& v : t) {
            if (number[v] < 0) {
                number[v] = static_cast<Index>(part.vertex.size());
                part.vertex.push_back(v);
            }
            v = number[v];
        }
        problem.faces.push_back(t);
        problem.edges.push_back(whole.edges[f]);
        problem.inverse.push_back(whole.inverse[f]);
        problem.area.push_back(whole.area[f]);
        problem.cotangent.push_back(whole.cotangent[f]);
        problem.total_area += whole.area[f];
    }
    problem.vertex_count = static_cast<Index>(part.vertex.size());
    part.fixed.assign(part.vertex.size(), 0);
    for (std::size_t f = 0; f < whole.faces.size(); ++f)
        for (const Vertex v : whole.faces[f])
            if (inside[f] == 0 && number[v] >= 0)
                part.fixed[number[v]] = 1;
    return part;
}

} // namespace devseg::flatten
