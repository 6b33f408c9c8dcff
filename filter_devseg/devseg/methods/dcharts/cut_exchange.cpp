#include "devseg/methods/dcharts/cut_exchange.h"

#include <algorithm>
#include <iterator>
#include <utility>

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

namespace {

// The cuts inside one chart, and trees that may take their place.
class CutTree {
public:
    CutTree(const Mesh& mesh, const Draft& draft, Index chart)
        : mesh_(mesh), rim_(mesh.points.size()), goal_(mesh.points.size(), -1) {
        std::vector<std::uint8_t> on_rim(mesh.points.size(), 0);
        std::vector<Index> ends(mesh.points.size(), 0); // of cuts, by vertex
        const std::vector<Index>& faces = draft.faces[chart];
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f)) {
                if (mesh.twin[h] < 0 || draft.chart[mesh.across(h)] != chart) {
                    on_rim[mesh.origin(h)] = on_rim[mesh.target(h)] = 1;
                    rim_.join(rim_.find(mesh.origin(h)), rim_.find(mesh.target(h)));
                } else if (draft.seam[h] != 0) {
                    ++ends[mesh.origin(h)];
                    if (h < mesh.twin[h])
                        cuts_.push_back(h);
                }
            }
        std::sort(cuts_.begin(), cuts_.end());
        inner_ = make_buckets<HalfEdge>(mesh.vertex_count(), [&](auto put) {
            for (const Face f : faces)
                for (const HalfEdge h : half_edges_of(f))
                    if (mesh.twin[h] >= 0 && draft.chart[mesh.across(h)] == chart)
                        put(mesh.origin(h), h);
        });
        add_goals(faces, on_rim, ends);
    }

    double length() const { return cost_of(cuts_); }
    Index tips() const { return static_cast<Index>(goals_.size()) - rims_; }

    // Half-edges, ascending, the lower one of each edge; `without`: number of a tip.
    std::vector<Index> tree(Index without, const Progress& progress) const {
        std::vector<Index> edges;
        std::vector<std::uint8_t> reached(goals_.size(), 0);
        graph::ShortestPaths<> paths(mesh_.points.size());
        const Index skipped = without < 0 ? -1 : rims_ + without;
        Index open = static_cast<Index>(goals_.size()) - (without < 0 ? 1 : 2);
        reach(skipped == 0 ? 1 : 0, reached, paths);
        while (open-- > 0)
            paths.run(
                [&](Vertex v, double distance) {
                    const Index goal = goal_[v];
                    if (goal >= 0 && goal != skipped && reached[at(goal)] == 0) {
                        take(v, paths, edges);
                        reach(goal, reached, paths);
                        return false;
                    }
                    for (const HalfEdge h : inner_[v])
                        paths.reach(mesh_.target(h), distance + atlas::cut_cost(mesh_, h), h);
                    return true;
                },
                progress);
        std::sort(edges.begin(), edges.end());
        return edges;
    }

    double cost_of(const std::vector<Index>& edges) const {
        double cost = 0.0;
        for (const HalfEdge h : edges)
            cost += atlas::cut_cost(mesh_, h);
        return cost;
    }
    const std::vector<Index>& cuts() const { return cuts_; }

private:
    // Each part of the rim is one, and each end of a cut.
    void add_goals(const std::vector<Index>& faces, const std::vector<std::uint8_t>& on_rim,
                   const std::vector<Index>& ends) {
        std::vector<Index> tips;
        std::vector<Index> number(mesh_.points.size(), -1); // by the rim's first vertex
        for (const Face f : faces)
            for (const Vertex v : mesh_.faces[f]) {
                if (goal_[v] >= 0)
                    continue;
                if (on_rim[v] != 0) {
                    Index& goal = number[rim_.find(v)];
                    if (goal < 0) {
                        goal = static_cast<Index>(goals_.size());
                        goals_.emplace_back();
                    }
                    goal_[v] = goal;
                    goals_[at(goal)].push_back(v);
                } else if (ends[v] == 1) {
                    tips.push_back(v);
                }
            }
        rims_ = static_cast<Index>(goals_.size());
        for (const Index v : tips)
            if (goal_[at(v)] < 0) {
                goal_[at(v)] = static_cast<Index>(goals_.size());
                goals_.push_back({v});
            }
    }

    void reach(Index goal, std::vector<std::uint8_t>& reached,
               graph::ShortestPaths<>& paths) const {
        reached[at(goal)] = 1;
        for (const Index v : goals_[at(goal)])
            paths.add_source(v);
    }

    // The path to a vertex becomes part of the tree.
    void take(Vertex v, graph::ShortestPaths<>& paths, std::vector<Index>& edges) const {
        std::vector<Index> way;
        while (paths.step[v] >= 0) {
            const HalfEdge h = paths.step[v];
            edges.push_back(std::min<Index>(h, mesh_.twin[h]));
            way.push_back(v);
            v = mesh_.origin(h);
        }
        for (const Index u : way)
            paths.add_source(u);
    }

    const Mesh& mesh_;
    graph::Unions rim_;
    std::vector<Index> cuts_;               // half-edges, ascending
    Buckets<HalfEdge> inner_;               // from each vertex, inside the chart
    std::vector<Index> goal_;               // #V: which one it belongs to, or −1
    std::vector<std::vector<Index>> goals_; // vertices of each: first the parts of the rim
    Index rims_ = 0;
};

} // namespace

std::vector<Closing> rerouted_cuts(const Mesh& mesh, const Draft& draft, Index chart,
                                   const Progress& progress) {
    const CutTree cuts(mesh, draft, chart);
    std::vector<Closing> closings;
    const double longest = worthwhile * cuts.length();
    for (Index without = -1; without < cuts.tips() && cuts.tips() > 1; ++without) {
        const std::vector<Index> tree = cuts.tree(without, progress);
        if (!(cuts.cost_of(tree) < longest))
            continue;
        Closing closing{{chart, chart}, {}, {}};
        std::set_difference(cuts.cuts().begin(), cuts.cuts().end(), tree.begin(), tree.end(),
                            std::back_inserter(closing.edges));
        std::set_difference(tree.begin(), tree.end(), cuts.cuts().begin(), cuts.cuts().end(),
                            std::back_inserter(closing.opened));
        closings.push_back(std::move(closing));
    }
    return closings;
}

} // namespace devseg::dcharts
