#include "devseg/methods/dcharts/seam_chains.h"

#include <algorithm>
#include <cmath>

#include "devseg/base/buckets.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/methods/dcharts/tuning.h"

namespace devseg::dcharts {

SeamChains::SeamChains(const Mesh& mesh, bool keep_corners)
    : mesh_(mesh), corner_(mesh::boundary_vertices(mesh)) {
    for (const HalfEdge h : mesh_.all_half_edges())
        if (mesh_.twin[h] >= 0)
            seams_.push_back(h);
    if (!keep_corners)
        return;
    const std::vector<double> defects = mesh::angle_defects(mesh);
    for (std::size_t v = 0; v < defects.size(); ++v)
        if (std::abs(defects[v]) > tuning.corner_defect)
            corner_[v] = corner;
}

void SeamChains::open(const std::vector<Index>& edges) {
    for (const HalfEdge h : edges)
        for (const HalfEdge side : {h, HalfEdge(mesh_.twin[h])})
            if (const auto place = std::lower_bound(seams_.begin(), seams_.end(), side);
                place == seams_.end() || *place != side)
                seams_.insert(place, side);
}

std::vector<Closing> SeamChains::find(const Draft& draft) {
    const auto is_none = [&](HalfEdge h) {
        return draft.seam[h] == 0 && draft.chart[face_of(h)] == draft.chart[mesh_.across(h)];
    };
    seams_.erase(std::remove_if(seams_.begin(), seams_.end(), is_none), seams_.end());
    const Buckets<HalfEdge> leaving = make_buckets<HalfEdge>(mesh_.vertex_count(), [&](auto put) {
        for (const HalfEdge h : seams_)
            put(mesh_.origin(h), h);
    });
    const auto is_node = [&](Vertex v) { return corner_[v] != 0 || leaving[v].size() != 2; };
    std::vector<std::uint8_t> seen(mesh_.twin.size(), 0);
    std::vector<Closing> chains;
    const auto trace = [&](HalfEdge h) {
        Closing chain;
        chain.charts =
            std::minmax(Index{draft.chart[face_of(h)]}, Index{draft.chart[mesh_.across(h)]});
        while (seen[h] == 0) {
            seen[h] = seen[mesh_.twin[h]] = 1;
            chain.edges.push_back(std::min<Index>(h, mesh_.twin[h]));
            const Vertex v = mesh_.target(h);
            if (is_node(v))
                break;
            const Span<HalfEdge> both = leaving[v];
            h = *both.begin() == mesh_.twin[h] ? *(both.begin() + 1) : *both.begin();
        }
        chains.push_back(std::move(chain));
    };
    for (const HalfEdge h : seams_)
        if (seen[h] == 0 && is_node(mesh_.origin(h)))
            trace(h);
    for (const HalfEdge h : seams_) // loops without a node
        if (seen[h] == 0)
            trace(h);
    return chains;
}

Vertex vertex_between(const Mesh& mesh, HalfEdge h, HalfEdge k) {
    const Vertex v = mesh.origin(h);
    return v == mesh.origin(k) || v == mesh.target(k) ? v : mesh.target(h);
}

void begin_loop_at(const Mesh& mesh, const std::function<bool(Vertex)>& may_begin,
                   std::vector<Index>& edges) {
    const HalfEdge first = edges.front();
    const HalfEdge last = edges.back();
    const Vertex v = vertex_between(mesh, last, first);
    if (edges.size() < 3 || (v != mesh.origin(first) && v != mesh.target(first)) || may_begin(v))
        return;
    for (std::size_t i = 1; i < edges.size(); ++i)
        if (may_begin(vertex_between(mesh, edges[i - 1], edges[i]))) {
            std::rotate(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(i), edges.end());
            return;
        }
}

std::vector<HalfEdge> left_border(const Mesh& mesh, const Draft& draft, const Closing& closing) {
    const auto [a, b] = closing.charts;
    std::vector<HalfEdge> left;
    if (a == b)
        return left;
    for (const Face f : draft.faces[draft.faces[a].size() < draft.faces[b].size() ? a : b])
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            if (twin < 0 || draft.chart[face_of(twin)] == draft.chart[f])
                continue;
            const Index other = draft.chart[face_of(twin)];
            const Index edge = std::min<Index>(h, twin);
            if ((other == a || other == b) &&
                std::find(closing.edges.begin(), closing.edges.end(), edge) == closing.edges.end())
                left.push_back(edge);
        }
    return left;
}

} // namespace devseg::dcharts
