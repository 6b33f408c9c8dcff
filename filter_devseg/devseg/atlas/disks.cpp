#include "devseg/atlas/disks.h"

#include <algorithm>
#include <utility>

#include "devseg/atlas/handle_cutter.h"
#include "devseg/atlas/join_loops.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/graph/unions.h"

namespace devseg::atlas {

namespace {

// Shortest paths along edges to the only boundary loop, or to a root where there is none. The last
// step is the half-edge from the vertex that leads nearer.
using PathForest = graph::ShortestPaths<>;

double edge_length(const Mesh& mesh, const ChartSurface& s, HalfEdge h) {
    return mesh.edge_length(s.mesh_half_edge(h));
}

PathForest grow_paths(const Mesh& mesh, const ChartSurface& s, const Buckets<HalfEdge>& edges,
                      Index root, const Progress& progress) {
    PathForest forest(s.vertex.size());
    if (s.loops.empty())
        forest.add_source(root);
    else
        for (const HalfEdge h : s.loops.front())
            forest.add_source(s.origin(h));
    forest.run(
        [&](Vertex v, double distance) {
            for (const HalfEdge e : edges[v])
                forest.reach(s.target(e), distance + edge_length(mesh, s, e), s.twin[e]);
        },
        progress);
    return forest;
}

class Cutter {
public:
    Cutter(const Mesh& mesh, const ChartSurface& surface, std::vector<std::uint8_t>& seam,
           const Progress& progress)
        : mesh_(mesh), s_(surface), seam_(seam), progress_(progress) {}

    // For charts with several boundary loops. Returns the length of the cuts, as all of these.
    double join() { return cut(join_loops(mesh_, s_, progress_)); }

    double cut(const std::vector<Index>& half_edges) {
        for (const HalfEdge h : half_edges)
            cut_edge(h);
        return length_;
    }

    void cut_path(const PathForest& forest, Vertex v) {
        for (; forest.step[v] >= 0; v = s_.target(forest.step[v]))
            cut_edge(forest.step[v]);
    }
    double length() const { return length_; }

    static Index farthest(const PathForest& forest) {
        return static_cast<Index>(std::max_element(forest.distance.begin(), forest.distance.end()) -
                                  forest.distance.begin());
    }

    // For charts with at most one loop.
    double cut_handles() {
        const Buckets<HalfEdge> edges = inner_half_edges(s_);
        const PathForest forest = grow_paths(mesh_, s_, edges, 0, progress_);
        for (const HalfEdge h : handle_edges(forest)) {
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
        for (const HalfEdge h : s_.loops.front())
            on_boundary[s_.origin(h)] = 1;
        Index shortest = -1;
        for (const HalfEdge h : s_.all_half_edges())
            if (on_boundary[s_.origin(h)] != 0 && on_boundary[s_.target(h)] == 0 &&
                (shortest < 0 || edge_length(mesh_, s_, h) < edge_length(mesh_, s_, shortest)))
                shortest = h;
        if (shortest >= 0)
            cut_edge(shortest);
        return length_;
    }

private:
    void cut_edge(HalfEdge h) {
        const HalfEdge a = s_.mesh_half_edge(h);
        const HalfEdge b = s_.mesh_half_edge(s_.twin[h]);
        if (seam_[a] == 0)
            length_ += mesh_.edge_length(a);
        seam_[a] = seam_[b] = 1;
        any_cut_ = true;
    }

    // The cycles through handles of a closed chart may hang together only by a path from the
    // root, which cuts nothing apart: take it back.
    void drop_stem(const Buckets<HalfEdge>& edges, Vertex v) {
        while (true) {
            Index only = -1;
            int count = 0;
            for (const HalfEdge e : edges[v])
                if (seam_[s_.mesh_half_edge(e)] != 0) {
                    only = e;
                    ++count;
                }
            if (count != 1)
                return;
            length_ -= edge_length(mesh_, s_, only);
            seam_[s_.mesh_half_edge(only)] = 0;
            seam_[s_.mesh_half_edge(s_.twin[only])] = 0;
            v = s_.target(only);
        }
    }

    // The edges outside the path forest and outside the maximum spanning tree of the dual graph,
    // [EHP04, section 5]: two for each handle. An edge weighs as much as the cycle that it closes.
    std::vector<Index> handle_edges(const PathForest& forest) const {
        struct Dual {
            double cycle;
            HalfEdge half_edge;
        };
        std::vector<Dual> duals;
        Heartbeat beat(progress_);
        for (const HalfEdge h : s_.all_half_edges()) {
            beat();
            const HalfEdge opposite = s_.twin[h];
            if (opposite < h || in_forest(forest, h) || in_forest(forest, opposite))
                continue;
            duals.push_back({forest.distance[s_.origin(h)] + forest.distance[s_.target(h)] +
                                 edge_length(mesh_, s_, h),
                             h});
        }
        std::stable_sort(duals.begin(), duals.end(),
                         [](const Dual& a, const Dual& b) { return a.cycle > b.cycle; });
        graph::Unions tree(s_.faces.size());
        std::vector<Index> rest;
        for (const Dual& dual : duals) {
            beat();
            const Index a = tree.find(face_of(dual.half_edge));
            const Index b = tree.find(s_.across(dual.half_edge));
            if (a == b)
                rest.push_back(dual.half_edge);
            else
                tree.join(b, a);
        }
        return rest;
    }

    bool in_forest(const PathForest& forest, HalfEdge h) const {
        return forest.step[s_.origin(h)] == h;
    }

    // No boundary and no handle: a slit between two vertices that are far from each other.
    void cut_sphere(const Buckets<HalfEdge>& edges, const PathForest& forest) {
        const Index far = farthest(forest);
        const PathForest from_far = grow_paths(mesh_, s_, edges, far, progress_);
        cut_path(from_far, farthest(from_far));
    }

    const Mesh& mesh_;
    const ChartSurface& s_;
    std::vector<std::uint8_t>& seam_;
    const Progress& progress_;
    double length_ = 0.0;
    bool any_cut_ = false;
};

// Cuts of one way to open a chart.
struct Opening {
    std::vector<std::uint8_t> seam; // 3 #F
    ChartSurface surface;           // may have a boundary of two edges
    double length = 0.0;
};

void join(const Mesh& mesh, Opening& opening, const Progress& progress) {
    if (opening.surface.loops.size() < 2)
        return;
    opening.length += Cutter(mesh, opening.surface, opening.seam, progress).join();
    opening.surface = extract_surface(mesh, std::move(opening.surface.face), opening.seam);
}

// [EHP04], once all loops are joined.
void open_joined_first(const Mesh& mesh, Opening& opening, const Progress& progress) {
    join(mesh, opening, progress);
    if (opening.surface.is_disk())
        return;
    opening.length += Cutter(mesh, opening.surface, opening.seam, progress).cut_handles();
    opening.surface = extract_surface(mesh, std::move(opening.surface.face), opening.seam);
}

// [YGZS05]: a loop through each handle, then the loops are joined.
void open_handles_first(const Mesh& mesh, Opening& opening, const Progress& progress) {
    opening.length += Cutter(mesh, opening.surface, opening.seam, progress)
                          .cut(cut_handles(mesh, opening.surface, progress));
    opening.surface = extract_surface(mesh, std::move(opening.surface.face), opening.seam);
    join(mesh, opening, progress);
}

bool has_handles(const ChartSurface& surface) {
    return surface.euler_characteristic() + static_cast<Index>(surface.loops.size()) < 2;
}

} // namespace

ChartSurface cut_to_disk(const Mesh& mesh, ChartSurface surface, std::vector<std::uint8_t>& seam,
                         const Progress& progress, double* cut_length) {
    double length = 0.0;
    if (!surface.is_disk()) {
        Opening best{seam, surface, 0.0};
        open_joined_first(mesh, best, progress);
        if (has_handles(surface)) {
            Opening other{seam, surface, 0.0};
            open_handles_first(mesh, other, progress);
            if (other.surface.is_disk() && other.length < best.length)
                best = std::move(other);
        }
        seam = std::move(best.seam);
        surface = std::move(best.surface);
        length += best.length;
    }
    if (surface.loops.front().size() < 3) {
        length += Cutter(mesh, surface, seam, progress).lengthen();
        surface = extract_surface(mesh, std::move(surface.face), seam);
    }
    if (cut_length != nullptr)
        *cut_length += length;
    return surface;
}

Index cut_to_tips(const Mesh& mesh, const ChartSurface& disk, std::vector<std::uint8_t>& seam,
                  const TipRule& rule, double& cut_length, const Progress& progress) {
    const Buckets<HalfEdge> edges = inner_half_edges(disk);
    const PathForest forest = grow_paths(mesh, disk, edges, 0, progress);
    const std::vector<Index> tips = find_tips(mesh, disk, forest.distance, rule, progress);
    Cutter cutter(mesh, disk, seam, progress);
    for (const Index tip : tips)
        cutter.cut_path(forest, tip);
    cut_length += cutter.length();
    return static_cast<Index>(tips.size());
}

DiskCuts cut_charts_to_disks(const Mesh& mesh, const ChartMap& charts, const DiskOptions& options,
                             Progress& progress) {
    DiskCuts result;
    result.charts = charts;
    progress.check();
    std::vector<ChartSurface> surfaces = extract_charts(mesh, charts);
    for (std::size_t c = 0; c < surfaces.size(); ++c) {
        progress.update(static_cast<double>(c) / static_cast<double>(surfaces.size()));
        const double before = result.cut_length;
        if (!surfaces[c].is_disk() || surfaces[c].loops.front().size() < 3)
            surfaces[c] = cut_to_disk(mesh, std::move(surfaces[c]), result.charts.seam, progress,
                                      &result.cut_length);
        if (options.cut_tips)
            result.cut_tips += cut_to_tips(mesh, surfaces[c], result.charts.seam, options.tip_rule,
                                           result.cut_length, progress);
        result.cut_charts += result.cut_length > before ? 1 : 0;
    }
    return result;
}

DiskCuts cut_charts_to_disks(const Mesh& mesh, const ChartMap& charts, Progress& progress) {
    return cut_charts_to_disks(mesh, charts, {false, {}}, progress);
}

} // namespace devseg::atlas
