#include "devseg/atlas/border_path.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "devseg/atlas/join_loops.h"

namespace devseg::atlas {

namespace {

constexpr double least_crease_factor = 0.1;

} // namespace

double crease_factor(const Mesh& mesh, HalfEdge h) {
    const double cosine = mesh.face_normals[h / 3].dot(mesh.face_normals[mesh.twin[h] / 3]);
    return std::max(least_crease_factor, cosine);
}

std::vector<Index> path_to_border(const Mesh& mesh, const std::vector<Index>& faces,
                                  const std::vector<std::uint8_t>& seam, Vertex vertex) {
    const ChartSurface s = extract_surface(mesh, faces, enclose(mesh, faces, seam));
    std::vector<std::uint8_t> goal(s.vertex.size(), 0);
    for (const std::vector<Index>& loop : s.loops)
        for (const HalfEdge h : loop)
            goal[s.origin(h)] = 1;
    const auto found = std::find(s.vertex.begin(), s.vertex.end(), vertex);
    if (found == s.vertex.end() || goal[static_cast<Index>(found - s.vertex.begin())] != 0)
        return {};
    const Index start = static_cast<Index>(found - s.vertex.begin());

    const VertexEdges edges(s);
    std::vector<double> distance(s.vertex.size(), infinite);
    std::vector<Index> arrival(s.vertex.size(), -1);
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    distance[start] = 0.0;
    queue.emplace(0.0, start);
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > distance[v])
            continue;
        if (goal[v] != 0) {
            std::vector<Index> path;
            for (Index u = v; u != start; u = s.origin(arrival[u]))
                path.push_back(s.mesh_half_edge(arrival[u]));
            return path;
        }
        for (const Index* e = edges.first(v); e != edges.last(v); ++e) {
            if (s.twin[*e] < 0)
                continue;
            const HalfEdge h = s.mesh_half_edge(*e);
            const Index w = s.target(*e);
            const double through = d + crease_factor(mesh, h) * mesh.edge_length(h);
            if (through < distance[w]) {
                distance[w] = through;
                arrival[w] = *e;
                queue.emplace(through, w);
            }
        }
    }
    return {};
}

void mark_cuts(const Mesh& mesh, const std::vector<Index>& half_edges,
               std::vector<std::uint8_t>& seam) {
    for (const HalfEdge h : half_edges)
        seam[h] = seam[mesh.twin[h]] = 1;
}

} // namespace devseg::atlas
