#include "devseg/curves/curved_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "devseg/mesh/angle_defects.h"

namespace devseg::curves {

namespace {

struct Tuning {
    // Curvature, in radians, of vertices that free, near and nearer seams never leave,
    std::array<double, 3> kept{40.0 * degrees, 10.0 * degrees, 2.0 * degrees};
    double drawn = 15.0 * degrees; // and of those that free ones go back to.
};
constexpr Tuning tuning;

// The firmest seam at each vertex of a face that touches it: curves that leave it stay among them
// for long. Held ones go nowhere.
std::vector<Firmness> firmness_near(const Mesh& mesh, const std::vector<Firmness>& firmness) {
    std::vector<Firmness> on(mesh.points.size(), Firmness::free);
    const auto raise = [](Firmness& at_vertex, Firmness of_seam) {
        if (of_seam != Firmness::held)
            at_vertex = std::max(at_vertex, of_seam);
    };
    for (const HalfEdge h : mesh.all_half_edges())
        for (const Vertex v : {mesh.origin(h), mesh.target(h)})
            raise(on[v], firmness[h]);
    std::vector<Firmness> near = on;
    for (const HalfEdge h : mesh.all_half_edges())
        for (const Vertex v : {mesh.target(h), mesh.origin(Mesh::previous(h))})
            raise(near[v], on[mesh.origin(h)]);
    return near;
}

} // namespace

CurvedVertices::CurvedVertices(const Mesh& mesh, const std::vector<Firmness>& firmness)
    : defect_(mesh::angle_defects(mesh)), firmness_(firmness_near(mesh, firmness)) {
    for (double& d : defect_)
        d = std::abs(d);
}

bool CurvedVertices::keeps_seams(Vertex v) const {
    return defect_[v] > tuning.kept[static_cast<std::size_t>(firmness_[v])];
}

bool CurvedVertices::draws_seams(Vertex v) const {
    return defect_[v] >=
           std::min(tuning.drawn, tuning.kept[static_cast<std::size_t>(firmness_[v])]);
}

} // namespace devseg::curves
