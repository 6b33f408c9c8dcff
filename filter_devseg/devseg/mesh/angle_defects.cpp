#include "devseg/mesh/angle_defects.h"

namespace devseg::mesh {

std::vector<double> angle_defects(const Mesh& mesh) {
    std::vector<double> defect(mesh.points.size(), 2.0 * pi);
    for (const HalfEdge h : mesh.all_half_edges())
        defect[mesh.origin(h)] -= corner_angle(
            mesh.points[mesh.origin(h)], mesh.points[mesh.target(h)], mesh.points[mesh.apex(h)]);
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh);
    for (std::size_t v = 0; v < defect.size(); ++v)
        if (boundary[v] != 0)
            defect[v] = 0.0;
    return defect;
}

std::vector<Index> leaving_half_edges(const Mesh& mesh) {
    std::vector<Index> leaving(mesh.points.size(), -1);
    for (const HalfEdge h : mesh.all_half_edges())
        if (leaving[mesh.origin(h)] < 0 || mesh.twin[h] < 0)
            leaving[mesh.origin(h)] = h;
    return leaving;
}

std::vector<std::uint8_t> boundary_vertices(const Mesh& mesh) {
    std::vector<std::uint8_t> boundary(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] < 0)
            boundary[mesh.origin(h)] = boundary[mesh.target(h)] = 1;
    return boundary;
}

} // namespace devseg::mesh
