#include "devseg/atlas/opening.h"

#include <numeric>

#include "devseg/atlas/charts.h"

namespace devseg::atlas {

mesh::Refinement open_along(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    std::vector<Index> all(mesh.faces.size());
    std::iota(all.begin(), all.end(), 0);
    const ChartSurface surface = extract_surface(mesh, std::move(all), seam);
    std::vector<Index> number(surface.vertex.size(), -1); // in the opened mesh
    std::vector<std::uint8_t> seen(mesh.points.size(), 0);
    Index next = mesh.vertex_count();
    for (const Vertex v : surface.all_vertices()) {
        const Vertex old = surface.vertex[v];
        number[v] = seen[old] == 0 ? Index{old} : next++;
        seen[old] = 1;
    }
    mesh::Refinement result;
    Mesh& open = result.mesh;
    open.points = mesh.points;
    open.points.resize(at(next));
    open.unit_length = mesh.unit_length;
    open.whole_area = mesh.whole_area;
    open.faces = mesh.faces;
    open.twin = surface.twin;
    result.points.resize(at(next - mesh.vertex_count()));
    for (const Face f : mesh.all_faces()) {
        mesh::Refinement::Part part{f, f, {Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2)}};
        for (Index k = 0; k < 3; ++k)
            open.faces[f][at(k)] = number[surface.faces[f][at(k)]];
        if (open.faces[f] != mesh.faces[f])
            result.parts.push_back(part);
        for (Index k = 0; k < 3; ++k)
            if (const Index v = open.faces[f][at(k)]; v >= mesh.vertex_count()) {
                open.points[at(v)] = mesh.points[mesh.faces[f][at(k)]];
                result.points[at(v - mesh.vertex_count())] = {f, Vec3::Unit(k)};
            }
    }
    compute_face_geometry(open);
    return result;
}

} // namespace devseg::atlas
