#include "devseg/mesh/empty_parts.h"

#include <algorithm>

namespace devseg::mesh {

namespace {

// A part by its longest edge.
struct Extent {
    double area = 0.0;
    double longest = 0.0;
    HalfEdge edge;
    double breadth = 0.0; // largest distance of a vertex from the line of that edge
};

} // namespace

std::vector<std::uint8_t> find_empty_parts(const Mesh& mesh, double width) {
    const FaceComponents parts = face_components(mesh, [](HalfEdge) { return true; });
    std::vector<Extent> extent(at(parts.count));
    for (const Face f : mesh.all_faces()) {
        const auto [v, w, u] = mesh.faces[f];
        Extent& part = extent[at(parts.label[f])];
        part.area +=
            0.5 * (mesh.points[w] - mesh.points[v]).cross(mesh.points[u] - mesh.points[v]).norm();
        for (const HalfEdge h : half_edges_of(f))
            if (const double length = mesh.edge_length(h); part.edge < 0 || length > part.longest) {
                part.longest = length;
                part.edge = h;
            }
    }
    for (const HalfEdge h : mesh.all_half_edges()) {
        Extent& part = extent[at(parts.label[face_of(h)])];
        const Vec3& start = mesh.points[mesh.origin(part.edge)];
        const Vec3 along = mesh.points[mesh.target(part.edge)] - start;
        const Vec3 away = mesh.points[mesh.origin(h)] - start;
        part.breadth =
            std::max(part.breadth,
                     part.longest > 0.0 ? along.cross(away).norm() / part.longest : away.norm());
    }
    const auto is_empty = [&](const Extent& part) {
        return part.breadth <= width || part.area <= width * part.longest;
    };
    std::vector<std::uint8_t> empty(mesh.faces.size(), 0);
    for (const Face f : mesh.all_faces())
        empty[f] = is_empty(extent[at(parts.label[f])]) ? 1 : 0;
    if (std::find(empty.begin(), empty.end(), 0) == empty.end())
        empty.assign(empty.size(), 0);
    return empty;
}

} // namespace devseg::mesh
