#include "devseg/methods/dcharts/cut_exchange.h"

#include <algorithm>

#include "devseg/atlas/border_path.h"
#include "devseg/base/buckets.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/graph/unions.h"

namespace devseg::dcharts {

namespace {

// A new cut is worth the trial if it is shorter than this share of the old one.
constexpr double worthwhile = 0.97;

// The seams of a chart without one chain.
class OtherSeams {
public:
    OtherSeams(const Mesh& mesh, const Draft& draft, const Closing& chain)
        : mesh_(mesh), draft_(draft), chart_(chain.charts.first), edges_(chain.edges),
          part_(mesh.points.size()), on_seam_(mesh.points.size(), 0) {
        std::sort(edges_.begin(), edges_.end());
        for (const Face f : draft.faces[chart_])
            for (const HalfEdge h : half_edges_of(f))
                if (is_seam(h)) {
                    part_.join(part(mesh.origin(h)), part(mesh.target(h)));
                    on_seam_[mesh.origin(h)] = on_seam_[mesh.target(h)] = 1;
                }
    }

    Index part(Vertex v) { return part_.find(v); }
    bool is_on(Vertex v) const { return on_seam_[v] != 0; }
    bool is_seam(HalfEdge h) const {
        const HalfEdge twin = mesh_.twin[h];
        if (twin < 0)
            return true;
        return (draft_.seam[h] != 0 || draft_.chart[face_of(twin)] != chart_) &&
               !std::binary_search(edges_.begin(), edges_.end(), std::min<Index>(h, twin));
    }

private:
    const Mesh& mesh_;
    const Draft& draft_;
    Index chart_;
    std::vector<Index> edges_;          // of the chain, ascending
    graph::Unions part_;                // of vertices
    std::vector<std::uint8_t> on_seam_; // #V
};

// Vertices where just one edge of the chain ends; fewer than two for loops.
std::vector<Index> ends_of(const Mesh& mesh, const Closing& chain) {
    std::vector<Index> vertices;
    for (const HalfEdge h : chain.edges) {
        vertices.push_back(mesh.origin(h));
        vertices.push_back(mesh.target(h));
    }
    std::sort(vertices.begin(), vertices.end());
    std::vector<Index> ends;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if ((i == 0 || vertices[i] != vertices[i - 1]) &&
            (i + 1 == vertices.size() || vertices[i] != vertices[i + 1]))
            ends.push_back(vertices[i]);
    return ends;
}

} // namespace

std::vector<Index> shorter_cut(const Mesh& mesh, const Draft& draft, const Closing& chain,
                               const Progress& progress) {
    const std::vector<Index> ends = ends_of(mesh, chain);
    OtherSeams seams(mesh, draft, chain);
    if (ends.size() != 2 || seams.part(ends[0]) == seams.part(ends[1]))
        return {};
    const Index from = seams.part(ends[0]);
    const Index to = seams.part(ends[1]);
    const std::vector<Index>& faces = draft.faces[chain.charts.first];
    const auto inner = make_buckets<HalfEdge>(mesh.vertex_count(), [&](auto put) {
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f))
                if (!seams.is_seam(h))
                    put(mesh.origin(h), h);
    });
    double bound = 0.0;
    for (const HalfEdge h : chain.edges)
        bound += worthwhile * atlas::cut_cost(mesh, h);
    graph::ShortestPaths<> paths(mesh.points.size());
    for (const Face f : faces)
        for (const Vertex v : mesh.faces[f])
            if (v == ends[0] || (seams.is_on(v) && seams.part(v) == from))
                paths.add_source(v);
    std::vector<Index> path;
    paths.run(
        [&](Vertex v, double distance) {
            if (v == ends[1] || (seams.is_on(v) && seams.part(v) == to)) {
                for (Vertex u = v; paths.step[u] >= 0; u = mesh.origin(paths.step[u]))
                    path.push_back(paths.step[u]);
                return false;
            }
            if (seams.is_on(v) && seams.part(v) != from)
                return true; // a hole: a path that touched it twice would take the chart apart
            for (const HalfEdge h : inner[v])
                if (const double through = distance + atlas::cut_cost(mesh, h); through < bound)
                    paths.reach(mesh.target(h), through, h);
            return true;
        },
        progress);
    return path;
}

} // namespace devseg::dcharts
