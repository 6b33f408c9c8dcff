#include "devseg/methods/plush/open_part.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/mesh/surface_search.h"
#include "devseg/methods/plush/mend_patches.h"

namespace devseg::plush {

bool OpenPart::has_open_faces() const {
    return std::find(faces.begin(), faces.end(), 1) != faces.end();
}

bool OpenPart::is_inside(const Mesh& mesh, HalfEdge h) const {
    const HalfEdge twin = mesh.twin[h];
    return is_open(h / 3) && (twin < 0 || is_open(twin / 3));
}

OpenPart mend_patches(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& cost,
                      SeamMarks seam, const PatchLimits& limits, Progress& progress) {
    const mesh::FaceComponents patches = find_patches(mesh, seam);
    std::vector<std::vector<Index>> faces(at(patches.count));
    for (const Face f : mesh.all_faces())
        faces[patches.label[f]].push_back(f);
    std::vector<std::optional<std::vector<Index>>> cuts(faces.size());
    parallel_for(
        patches.count,
        [&](int p) { cuts[p] = mend_patch(mesh, graph, cost, faces[p], seam, limits, progress); },
        progress);
    OpenPart part;
    part.seam = std::move(seam);
    for (const auto& lines : cuts)
        for (const HalfEdge h : lines.value_or(std::vector<Index>{}))
            mark(mesh, h, 1, part.seam);
    for (const Index p : patches.label)
        part.faces.push_back(cuts[p] ? 0 : 1);
    return part;
}

SeamMarks fixed_seams(const Mesh& mesh, const OpenPart& part) {
    SeamMarks fixed = part.seam;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && part.is_inside(mesh, h))
            fixed[h] = 0;
    return fixed;
}

OpenPart same_part(const WorkingSurface& surface, SeamMarks seam, const Mesh& model,
                   const OpenPart& on_model) {
    const mesh::SurfaceSearch search(model);
    const std::vector<Vec3> normals = mesh::vertex_normals(surface.mesh);
    const mesh::FaceComponents patches = find_patches(surface.mesh, seam);
    std::vector<double> balance(at(patches.count), 0.0);
    for (const Face f : surface.mesh.all_faces()) {
        const Vertex v = surface.mesh.faces[f][0];
        const Index near =
            search.vertex(surface.mesh.points[v], normals[v], [](Index) { return true; });
        if (near >= 0)
            balance[patches.label[f]] += on_model.is_open(search.leaving(near) / 3)
                                             ? surface.mesh.face_areas[f]
                                             : -surface.mesh.face_areas[f];
    }
    OpenPart part;
    part.seam = std::move(seam);
    for (const Index p : patches.label)
        part.faces.push_back(balance[p] > 0.0 ? 1 : 0);
    for (Face f = 0; f < surface.mesh.face_count() && surface.is_symmetric(); ++f)
        if (part.faces[f] != 0)
            part.faces[surface.face_image(f)] = 1;
    return part;
}

} // namespace devseg::plush
