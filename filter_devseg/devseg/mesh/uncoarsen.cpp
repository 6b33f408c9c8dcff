#include "devseg/mesh/coarsen.h"

#include <utility>

namespace devseg::mesh {

HalfEdge undo_collapse(CoarseSurface& s) {
    const HalfEdge h = s.collapses.back();
    s.collapses.pop_back();
    for (const HalfEdge side : {s.twin[h], h}) {
        if (side < 0)
            continue;
        s.alive[face_of(side)] = 1;
        ++s.alive_faces;
        for (const HalfEdge k : {Mesh::next(side), Mesh::previous(side)})
            if (s.twin[k] >= 0)
                s.twin[s.twin[k]] = k;
    }
    const Vertex v = s.origin(h);
    visit_star(s, h, [&](HalfEdge k) { s.faces[face_of(k)][corner_of(k)] = v; });
    return h;
}

CoarseMesh extract_coarse_mesh(const Mesh& fine, CoarseSurface surface) {
    CoarseMesh result;
    std::vector<Index> number(surface.faces.size(), -1);
    std::vector<Index> vertex(fine.points.size(), -1);
    for (const Face f : fine.all_faces()) {
        if (surface.alive[f] == 0)
            continue;
        number[f] = static_cast<Index>(result.face.size());
        result.face.push_back(f);
        Triangle t = surface.faces[f];
        for (Index& v : t) {
            if (vertex[v] < 0) {
                vertex[v] = static_cast<Index>(result.vertex.size());
                result.vertex.push_back(v);
                result.mesh.points.push_back(fine.points[v]);
            }
            v = vertex[v];
        }
        result.mesh.faces.push_back(t);
    }
    for (const Face f : result.face)
        for (const HalfEdge h : half_edges_of(f)) {
            const Face g = surface.across(h);
            result.mesh.twin.push_back(g < 0 ? HalfEdge()
                                             : half_edge_of(number[g], corner_of(surface.twin[h])));
        }
    result.mesh.unit_length = fine.unit_length;
    compute_face_geometry(result.mesh);
    result.surface = std::move(surface);
    return result;
}

namespace {

// Length of the borders around the two faces beside h, had they these labels.
double border_length(const std::vector<Vec3>& points, const CoarseSurface& s, HalfEdge h,
                     const std::vector<Index>& label, Index here, Index there) {
    const auto length = [&](HalfEdge k) {
        return (points[s.origin(k)] - points[s.target(k)]).norm();
    };
    const HalfEdge twin = s.twin[h];
    double sum = twin >= 0 && here != there ? length(h) : 0.0;
    for (const auto& [side, own] : {std::pair(h, here), std::pair(twin, there)})
        if (side >= 0)
            for (const HalfEdge k : {Mesh::next(side), Mesh::previous(side)}) {
                const Face g = s.across(k);
                if (g >= 0 && label[g] != own)
                    sum += length(k);
            }
    return sum;
}

} // namespace

std::vector<Index> refine_labels(const Mesh& fine, const CoarseMesh& coarse,
                                 const std::vector<Index>& label, const Progress& progress) {
    CoarseSurface surface = coarse.surface;
    std::vector<Index> result(fine.faces.size(), -1);
    for (const Face f : coarse.mesh.all_faces())
        result[coarse.face[f]] = label[f];
    Heartbeat beat(progress);
    const auto across = [&](HalfEdge k) {
        const Face g = surface.across(k);
        return g < 0 ? -1 : result[g];
    };
    while (!surface.collapses.empty()) {
        beat();
        const HalfEdge h = undo_collapse(surface);
        const HalfEdge twin = surface.twin[h];
        double shortest = infinite;
        Index best_here = -1;
        Index best_there = -1;
        for (const Index a : {across(Mesh::next(h)), across(Mesh::previous(h))})
            for (const Index b : {twin < 0 ? a : across(Mesh::next(twin)),
                                  twin < 0 ? a : across(Mesh::previous(twin))}) {
                if (a < 0 || b < 0)
                    continue;
                const double length = border_length(fine.points, surface, h, result, a, b);
                if (length < shortest) {
                    shortest = length;
                    best_here = a;
                    best_there = b;
                }
            }
        result[face_of(h)] = best_here;
        if (twin >= 0)
            result[face_of(twin)] = best_there;
    }
    return result;
}

} // namespace devseg::mesh
