#include "devseg/cut/disks.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>

namespace devseg {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Shortest paths from the root, along edges; every boundary loop counts as one point.
struct PathForest {
    std::vector<double> distance; // #v: from the root, over the edges of the chart
    std::vector<Index> toward;    // #v: half-edge whose origin is the vertex, one step to the root;
                                  // −1 at the root and where the path goes on along a boundary
    std::vector<Index> loop_exit; // #loops: vertex where the path leaves the loop, −1 = root
    std::vector<Index> loop_of;   // #v: boundary loop of the vertex, −1 = inside
};

// Outgoing half-edges of each vertex and, for boundary vertices, the incoming boundary half-edge:
// enough to visit every edge at the vertex.
class VertexEdges {
public:
    explicit VertexEdges(const ChartSurface& s) : begin_(at(s.vertex_count()) + 1, 0) {
        const Index half_edges = 3 * s.face_count();
        const auto each = [&](auto visit) {
            for (Index h = 0; h < half_edges; ++h) {
                visit(s.origin(h), h);
                if (s.twin[at(h)] < 0)
                    visit(s.target(h), h);
            }
        };
        each([&](Index v, Index) { ++begin_[at(v) + 1]; });
        std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
        edges_.resize(at(begin_.back()));
        std::vector<Index> cursor(begin_.begin(), begin_.end() - 1);
        each([&](Index v, Index h) { edges_[at(cursor[at(v)]++)] = h; });
    }
    const Index* first(Index v) const { return edges_.data() + begin_[at(v)]; }
    const Index* last(Index v) const { return edges_.data() + begin_[at(v) + 1]; }

private:
    std::vector<Index> begin_;
    std::vector<Index> edges_;
};

double edge_length(const Mesh& mesh, const ChartSurface& s, Index h) {
    return mesh.edge_length(s.mesh_half_edge(h));
}

double loop_length(const Mesh& mesh, const ChartSurface& s, const std::vector<Index>& loop) {
    double sum = 0.0;
    for (const Index h : loop)
        sum += edge_length(mesh, s, h);
    return sum;
}

// Dijkstra from the longest boundary loop, or from `root` where there is no boundary.
PathForest grow_paths(const Mesh& mesh, const ChartSurface& s, const VertexEdges& edges,
                      Index root) {
    PathForest forest;
    forest.distance.assign(s.vertex.size(), infinity);
    forest.toward.assign(s.vertex.size(), -1);
    forest.loop_exit.assign(s.loops.size(), -1);
    forest.loop_of.assign(s.vertex.size(), -1);
    for (std::size_t l = 0; l < s.loops.size(); ++l)
        for (const Index h : s.loops[l])
            forest.loop_of[at(s.origin(h))] = static_cast<Index>(l);

    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto reach_loop = [&](Index loop, double d) {
        for (const Index h : s.loops[at(loop)]) {
            forest.distance[at(s.origin(h))] = d;
            queue.emplace(d, s.origin(h));
        }
    };
    if (s.loops.empty()) {
        forest.distance[at(root)] = 0.0;
        queue.emplace(0.0, root);
    } else {
        std::size_t longest = 0;
        for (std::size_t l = 1; l < s.loops.size(); ++l)
            if (loop_length(mesh, s, s.loops[l]) > loop_length(mesh, s, s.loops[longest]))
                longest = l;
        reach_loop(static_cast<Index>(longest), 0.0);
    }
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > forest.distance[at(v)])
            continue;
        for (const Index* e = edges.first(v); e != edges.last(v); ++e) {
            if (s.twin[at(*e)] < 0)
                continue; // the boundary is walked for free already
            const Index w = s.target(*e);
            const double through = d + edge_length(mesh, s, *e);
            if (!(through < forest.distance[at(w)]))
                continue;
            const Index back = s.twin[at(*e)];
            const Index loop = forest.loop_of[at(w)];
            if (loop >= 0) {
                // All vertices of a loop are one point; the first to arrive is the exit.
                if (forest.loop_exit[at(loop)] >= 0)
                    forest.toward[at(forest.loop_exit[at(loop)])] = -1;
                forest.loop_exit[at(loop)] = w;
                forest.toward[at(w)] = back;
                reach_loop(loop, through);
            } else {
                forest.toward[at(w)] = back;
                forest.distance[at(w)] = through;
                queue.emplace(through, w);
            }
        }
    }
    return forest;
}

class Cutter {
public:
    Cutter(const Mesh& mesh, const ChartSurface& surface, std::vector<std::uint8_t>& seam)
        : mesh_(mesh), s_(surface), seam_(seam) {}

    // Returns the length of the cuts.
    double run() {
        const VertexEdges edges(s_);
        const PathForest forest = grow_paths(mesh_, s_, edges, 0);
        for (const Index exit : forest.loop_exit)
            if (exit >= 0)
                cut_path(forest, exit);
        for (const Index h : handle_edges(forest)) {
            cut_edge(h);
            cut_path(forest, s_.origin(h));
            cut_path(forest, s_.target(h));
        }
        if (s_.loops.empty()) {
            if (any_cut_)
                drop_stem(edges, 0);
            else
                cut_sphere(edges, forest);
        }
        return length_;
    }

    // A boundary of two edges encloses nothing in the plane: cut one more edge, to an inner vertex.
    double lengthen() {
        std::vector<std::uint8_t> on_boundary(s_.vertex.size(), 0);
        for (const Index h : s_.loops.front())
            on_boundary[at(s_.origin(h))] = 1;
        Index shortest = -1;
        for (Index h = 0; h < 3 * s_.face_count(); ++h)
            if (on_boundary[at(s_.origin(h))] != 0 && on_boundary[at(s_.target(h))] == 0 &&
                (shortest < 0 || edge_length(mesh_, s_, h) < edge_length(mesh_, s_, shortest)))
                shortest = h;
        if (shortest >= 0)
            cut_edge(shortest);
        return length_;
    }

private:
    void cut_edge(Index h) {
        const Index a = s_.mesh_half_edge(h);
        const Index b = s_.mesh_half_edge(s_.twin[at(h)]);
        if (seam_[at(a)] == 0)
            length_ += mesh_.edge_length(a);
        seam_[at(a)] = seam_[at(b)] = 1;
        any_cut_ = true;
    }

    // The cycles through handles of a closed chart may hang together only by a path from the
    // root, which cuts nothing apart: take it back.
    void drop_stem(const VertexEdges& edges, Index v) {
        while (true) {
            Index only = -1;
            int count = 0;
            for (const Index* e = edges.first(v); e != edges.last(v); ++e)
                if (seam_[at(s_.mesh_half_edge(*e))] != 0) {
                    only = *e;
                    ++count;
                }
            if (count != 1)
                return;
            length_ -= edge_length(mesh_, s_, only);
            seam_[at(s_.mesh_half_edge(only))] = 0;
            seam_[at(s_.mesh_half_edge(s_.twin[at(only)]))] = 0;
            v = s_.target(only);
        }
    }

    // From v to the root. Where the path meets a boundary loop it goes on from the loop's exit.
    void cut_path(const PathForest& forest, Index v) {
        while (true) {
            const Index loop = forest.loop_of[at(v)];
            if (loop >= 0) {
                v = forest.loop_exit[at(loop)];
                if (v < 0)
                    return; // the root loop
            }
            const Index h = forest.toward[at(v)];
            if (h < 0)
                return; // the root vertex
            cut_edge(h);
            v = s_.target(h);
        }
    }

    // The edges outside the path forest and outside the maximum spanning tree of the dual graph,
    // [EHP04, section 5]: two for each handle. An edge weighs as much as the cycle that it closes.
    std::vector<Index> handle_edges(const PathForest& forest) const {
        struct Dual {
            double cycle;
            Index half_edge;
        };
        std::vector<Dual> duals;
        for (Index h = 0; h < 3 * s_.face_count(); ++h) {
            const Index opposite = s_.twin[at(h)];
            if (opposite < h)
                continue;
            if (in_forest(forest, h) || in_forest(forest, opposite))
                continue;
            duals.push_back({forest.distance[at(s_.origin(h))] +
                                 forest.distance[at(s_.target(h))] + edge_length(mesh_, s_, h),
                             h});
        }
        std::stable_sort(duals.begin(), duals.end(),
                         [](const Dual& a, const Dual& b) { return a.cycle > b.cycle; });
        std::vector<Index> parent(s_.face.size());
        std::iota(parent.begin(), parent.end(), 0);
        const auto find = [&](Index f) {
            while (parent[at(f)] != f)
                f = parent[at(f)] = parent[at(parent[at(f)])];
            return f;
        };
        std::vector<Index> rest;
        for (const Dual& dual : duals) {
            const Index a = find(dual.half_edge / 3);
            const Index b = find(s_.twin[at(dual.half_edge)] / 3);
            if (a == b)
                rest.push_back(dual.half_edge);
            else
                parent[at(a)] = b;
        }
        return rest;
    }

    static bool in_forest(const PathForest& forest, Index h, Index origin) {
        return forest.toward[at(origin)] == h;
    }
    bool in_forest(const PathForest& forest, Index h) const {
        return in_forest(forest, h, s_.origin(h));
    }

    // No boundary and no handle: a slit between two vertices that are far from each other.
    void cut_sphere(const VertexEdges& edges, const PathForest& forest) {
        const Index far = farthest(forest);
        const PathForest from_far = grow_paths(mesh_, s_, edges, far);
        cut_path(from_far, farthest(from_far));
    }
    static Index farthest(const PathForest& forest) {
        return static_cast<Index>(
            std::max_element(forest.distance.begin(), forest.distance.end()) -
            forest.distance.begin());
    }

    const Mesh& mesh_;
    const ChartSurface& s_;
    std::vector<std::uint8_t>& seam_;
    double length_ = 0.0;
    bool any_cut_ = false;
};

} // namespace

ChartSurface cut_to_disk(const Mesh& mesh, ChartSurface surface, std::vector<std::uint8_t>& seam,
                         double* cut_length) {
    double length = 0.0;
    if (!surface.is_disk()) {
        length += Cutter(mesh, surface, seam).run();
        surface = extract_surface(mesh, std::move(surface.face), seam);
    }
    if (surface.loops.front().size() < 3) {
        length += Cutter(mesh, surface, seam).lengthen();
        surface = extract_surface(mesh, std::move(surface.face), seam);
    }
    if (cut_length != nullptr)
        *cut_length += length;
    return surface;
}

DiskCuts cut_charts_to_disks(const Mesh& mesh, const ChartMap& charts, Progress& progress) {
    DiskCuts result;
    result.charts = charts;
    std::vector<ChartSurface> surfaces = extract_charts(mesh, charts);
    for (std::size_t c = 0; c < surfaces.size(); ++c) {
        progress.update(static_cast<double>(c) / static_cast<double>(surfaces.size()));
        if (surfaces[c].is_disk() && surfaces[c].loops.front().size() > 2)
            continue;
        ++result.cut_charts;
        cut_to_disk(mesh, std::move(surfaces[c]), result.charts.seam, &result.cut_length);
    }
    return result;
}

} // namespace devseg
