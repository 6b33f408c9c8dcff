#include "devseg/curves/curved_vertices.h"

#include <cmath>

#include "devseg/mesh/angle_defects.h"

namespace devseg::curves {

namespace {

struct Tuning {
    double sharp = 40.0 * degrees;  // curvature of vertices that seams never leave
    double curved = 15.0 * degrees; // and of those that they go back to
    double firm = 2.0 * degrees;    // the same near firm seams, which never leave the former
};
constexpr Tuning tuning;

// The vertices of faces that touch a firm seam: curves that leave it stay among them for long.
std::vector<std::uint8_t> vertices_near(const Mesh& mesh, const std::vector<std::uint8_t>& firm) {
    std::vector<std::uint8_t> on(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (firm[h] != 0)
            on[mesh.origin(h)] = on[mesh.target(h)] = 1;
    std::vector<std::uint8_t> near = on;
    for (const HalfEdge h : mesh.all_half_edges())
        if (on[mesh.origin(h)] != 0)
            near[mesh.target(h)] = near[mesh.origin(Mesh::previous(h))] = 1;
    return near;
}

} // namespace

CurvedVertices::CurvedVertices(const Mesh& mesh, const std::vector<std::uint8_t>& firm)
    : defect_(mesh::angle_defects(mesh)), firm_(vertices_near(mesh, firm)) {
    for (double& d : defect_)
        d = std::abs(d);
}

bool CurvedVertices::keeps_seams(Vertex v) const {
    return defect_[v] > (firm_[v] != 0 ? tuning.firm : tuning.sharp);
}

bool CurvedVertices::draws_seams(Vertex v) const {
    return defect_[v] >= (firm_[v] != 0 ? tuning.firm : tuning.curved);
}

} // namespace devseg::curves
