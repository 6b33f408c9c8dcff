#include "devseg/atlas/border_path.h"

#include <algorithm>

#include "devseg/atlas/join_loops.h"
#include "devseg/graph/shortest_paths.h"

namespace devseg::atlas {

namespace {

struct Tuning {
    double least_crease_factor = 0.1;
    // What an edge between two faces of one plane (normals within 1e-3 rad) costs to cut, over one
    // on a fold.
    double through_flat = 10.0;
    double flat_cosine = 1.0 - 0.5e-6;
    double uncut = 1e6; // the same for edges that are not to be cut: no way round costs as much
};
constexpr Tuning tuning;

double cosine_at(const Mesh& mesh, HalfEdge h) {
    return mesh.face_normals[face_of(h)].dot(mesh.face_normals[mesh.across(h)]);
}

} // namespace

double crease_factor(const Mesh& mesh, HalfEdge h) {
    return std::max(tuning.least_crease_factor, cosine_at(mesh, h));
}

double cut_cost(const Mesh& mesh, HalfEdge h) {
    return mesh.edge_length(h) *
           (cosine_at(mesh, h) >= tuning.flat_cosine ? tuning.through_flat : 1.0);
}

std::vector<Index> path_to_border(const Mesh& mesh, const std::vector<Index>& faces,
                                  const std::vector<std::uint8_t>& seam, Vertex vertex,
                                  const std::vector<std::uint8_t>& uncut) {
    const ChartSurface s = extract_surface(mesh, faces, enclose(mesh, faces, seam));
    std::vector<std::uint8_t> goal(s.vertex.size(), 0);
    for (const std::vector<Index>& loop : s.loops)
        for (const HalfEdge h : loop)
            goal[s.origin(h)] = 1;
    const auto found = std::find(s.vertex.begin(), s.vertex.end(), vertex);
    if (found == s.vertex.end() || goal[static_cast<Index>(found - s.vertex.begin())] != 0)
        return {};
    const Index start = static_cast<Index>(found - s.vertex.begin());

    const Buckets<HalfEdge> edges = inner_half_edges(s);
    graph::ShortestPaths<> paths(s.vertex.size());
    paths.add_source(start);
    std::vector<Index> path;
    paths.run([&](Vertex v, double distance) {
        if (goal[v] != 0) {
            for (Vertex u = v; u != start; u = s.origin(paths.step[u]))
                path.push_back(s.mesh_half_edge(paths.step[u]));
            return false;
        }
        for (const HalfEdge e : edges[v]) {
            const HalfEdge h = s.mesh_half_edge(e);
            const double factor = !uncut.empty() && uncut[h] != 0 ? tuning.uncut : 1.0;
            paths.reach(s.target(e), distance + factor * crease_factor(mesh, h) * cut_cost(mesh, h),
                        e);
        }
        return true;
    });
    return path;
}

void mark_cuts(const Mesh& mesh, const std::vector<Index>& half_edges,
               std::vector<std::uint8_t>& seam) {
    for (const HalfEdge h : half_edges)
        seam[h] = seam[mesh.twin[h]] = 1;
}

} // namespace devseg::atlas
