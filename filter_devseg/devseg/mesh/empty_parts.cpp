#include "devseg/mesh/empty_parts.h"

#include <algorithm>

namespace devseg::mesh {

std::vector<std::uint8_t> find_empty_parts(const Mesh& mesh, double width) {
    const FaceComponents parts = face_components(mesh, [](HalfEdge) { return true; });
    std::vector<double> area(at(parts.count), 0.0);
    std::vector<double> longest(at(parts.count), 0.0);
    std::vector<double> layers(at(parts.count), 2.0); // a closed part lies on itself
    for (const Face f : mesh.all_faces()) {
        const auto [v, w, u] = mesh.faces[f];
        const std::size_t part = at(parts.label[f]);
        area[part] +=
            0.5 * (mesh.points[w] - mesh.points[v]).cross(mesh.points[u] - mesh.points[v]).norm();
        for (const HalfEdge h : half_edges_of(f)) {
            longest[part] = std::max(longest[part], mesh.edge_length(h));
            if (mesh.twin[h] < 0)
                layers[part] = 1.0;
        }
    }
    const auto is_empty = [&](Index part) {
        return area[part] <= layers[part] * width * longest[part];
    };
    std::vector<std::uint8_t> empty(mesh.faces.size(), 0);
    for (const Face f : mesh.all_faces())
        empty[f] = is_empty(parts.label[f]) ? 1 : 0;
    if (std::find(empty.begin(), empty.end(), 0) == empty.end())
        empty.assign(empty.size(), 0);
    return empty;
}

} // namespace devseg::mesh
