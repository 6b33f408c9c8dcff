#include "devseg/atlas/disks.h"

#include <algorithm>
#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/handle_cutter.h"
#include "devseg/atlas/join_loops.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/graph/unions.h"

namespace devseg::atlas {

namespace {

// Shortest paths along edges to the boundary, or to a root where there is none. The last step is
// the half-edge from the vertex that leads nearer.
using PathForest = graph::ShortestPaths<>;

enum class Measure { length, cost };

double measure(const Mesh& mesh, const ChartSurface& s, HalfEdge h, Measure by) {
    const HalfEdge edge = s.mesh_half_edge(h);
    return by == Measure::cost ? cut_cost(mesh, edge) : mesh.edge_length(edge);
}

PathForest grow_paths(const Mesh& mesh, const ChartSurface& s, const Buckets<HalfEdge>& edges,
                      Index root, Measure by, const Progress& progress) {
    PathForest forest(s.vertex.size());
    if (s.loops.empty())
        forest.add_source(root);
    for (const std::vector<Index>& loop : s.loops)
        for (const HalfEdge h : loop)
            forest.add_source(s.origin(h));
    forest.run(
        [&](Vertex v, double distance) {
            for (const HalfEdge e : edges[v])
                forest.reach(s.target(e), distance + measure(mesh, s, e, by), s.twin[e]);
        },
        progress);
    return forest;
}

class Cutter {
public:
    Cutter(const Mesh& mesh, const ChartSurface& surface, std::vector<std::uint8_t>& seam,
           const Progress& progress)
        : mesh_(mesh), s_(surface), seam_(seam), progress_(progress) {}

    void join(const std::vector<std::uint8_t>& kept) {
        cut(join_loops(mesh_, s_, kept, progress_));
    }

    void cut(const std::vector<Index>& half_edges) {
        for (const HalfEdge h : half_edges)
            cut_edge(h);
    }

    void cut_path(const PathForest& forest, Vertex v) {
        for (; forest.step[v] >= 0; v = s_.target(forest.step[v]))
            cut_edge(forest.step[v]);
    }
    double length() const { return length_; } // of the new cuts
    double cost() const { return cost_; }

    static Index farthest(const PathForest& forest) {
        return static_cast<Index>(std::max_element(forest.distance.begin(), forest.distance.end()) -
                                  forest.distance.begin());
    }

    // For charts with at most one loop.
    void cut_handles() {
        const Buckets<HalfEdge> edges = inner_half_edges(s_);
        const PathForest forest = grow_paths(mesh_, s_, edges, 0, Measure::cost, progress_);
        for (const HalfEdge h : handle_edges(forest)) {
            cut_edge(h);
            cut_path(forest, s_.origin(h));
            cut_path(forest, s_.target(h));
        }
        if (s_.loops.empty()) {
            if (any_cut_)
                drop_stem(edges, 0);
            else
                cut_sphere(edges);
        }
    }

    // A boundary of two edges encloses nothing in the plane: cut one more edge, to an inner vertex.
    void lengthen() {
        std::vector<std::uint8_t> on_boundary(s_.vertex.size(), 0);
        for (const HalfEdge h : s_.loops.front())
            on_boundary[s_.origin(h)] = 1;
        Index shortest = -1;
        for (const HalfEdge h : s_.all_half_edges())
            if (on_boundary[s_.origin(h)] != 0 && on_boundary[s_.target(h)] == 0 &&
                (shortest < 0 || length_of(h) < length_of(shortest)))
                shortest = h;
        if (shortest >= 0)
            cut_edge(shortest);
    }

private:
    double length_of(HalfEdge h) const { return measure(mesh_, s_, h, Measure::length); }
    double cost_of(HalfEdge h) const { return measure(mesh_, s_, h, Measure::cost); }

    void cut_edge(HalfEdge h) {
        const HalfEdge a = s_.mesh_half_edge(h);
        const HalfEdge b = s_.mesh_half_edge(s_.twin[h]);
        if (seam_[a] == 0) {
            length_ += length_of(h);
            cost_ += cost_of(h);
        }
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
            length_ -= length_of(only);
            cost_ -= cost_of(only);
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
            duals.push_back(
                {forest.distance[s_.origin(h)] + forest.distance[s_.target(h)] + cost_of(h), h});
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
    void cut_sphere(const Buckets<HalfEdge>& edges) {
        const auto paths = [&](Index root, Measure by) {
            return grow_paths(mesh_, s_, edges, root, by, progress_);
        };
        const Index from = farthest(paths(0, Measure::length));
        const Index to = farthest(paths(from, Measure::length));
        cut_path(paths(from, Measure::cost), to);
    }

    const Mesh& mesh_;
    const ChartSurface& s_;
    std::vector<std::uint8_t>& seam_;
    const Progress& progress_;
    double length_ = 0.0;
    double cost_ = 0.0;
    bool any_cut_ = false;
};

// Cuts of one way to open a chart.
struct Opening {
    std::vector<std::uint8_t> seam; // 3 #F
    ChartSurface surface;           // may have a boundary of two edges
    double length = 0.0;
    double cost = 0.0;
};

template <class Cut>
void open(const Mesh& mesh, Opening& opening, const Progress& progress, Cut cut) {
    Cutter cutter(mesh, opening.surface, opening.seam, progress);
    cut(cutter);
    opening.length += cutter.length();
    opening.cost += cutter.cost();
    opening.surface = extract_surface(mesh, std::move(opening.surface.face), opening.seam);
}

void join(const Mesh& mesh, Opening& opening, const std::vector<std::uint8_t>& kept,
          const Progress& progress) {
    if (opening.surface.loops.size() > 1)
        open(mesh, opening, progress, [&](Cutter& cutter) { cutter.join(kept); });
}

// [EHP04], once all loops are joined.
void open_joined_first(const Mesh& mesh, Opening& opening, const Progress& progress) {
    join(mesh, opening, {}, progress);
    if (!opening.surface.is_disk())
        open(mesh, opening, progress, [](Cutter& cutter) { cutter.cut_handles(); });
}

// [YGZS05]: a loop through each handle, then the loops are joined.
void open_handles_first(const Mesh& mesh, Opening& opening, const Progress& progress) {
    open(mesh, opening, progress,
         [&](Cutter& cutter) { cutter.cut(cut_handles(mesh, opening.surface, progress)); });
    join(mesh, opening, {}, progress);
}

bool has_handles(const ChartSurface& surface) {
    return surface.euler_characteristic() + static_cast<Index>(surface.loops.size()) < 2;
}

// The cheapest way to make the chart sound.
Opening best_opening(const Mesh& mesh, const ChartSurface& surface,
                     const std::vector<std::uint8_t>& seam, const HoleRule& holes,
                     const Progress& progress) {
    const Opening closed{seam, surface};
    Opening best = closed;
    const bool handles = has_handles(surface);
    const std::vector<std::uint8_t> flat = flat_holes(mesh, surface, holes);
    if (!handles && std::find(flat.begin(), flat.end(), 1) != flat.end()) {
        join(mesh, best, flat, progress);
        if (is_sound(mesh, best.surface, holes))
            return best;
        best = closed;
    }
    open_joined_first(mesh, best, progress);
    if (handles) {
        Opening other = closed;
        open_handles_first(mesh, other, progress);
        if (other.surface.is_disk() && other.cost < best.cost)
            best = std::move(other);
    }
    return best;
}

bool is_too_short(const ChartSurface& surface) {
    return surface.is_disk() && surface.loops.front().size() < 3;
}

} // namespace

ChartSurface cut_to_disk(const Mesh& mesh, ChartSurface surface, std::vector<std::uint8_t>& seam,
                         const Progress& progress, double* cut_length, const HoleRule& holes) {
    double length = 0.0;
    if (!is_sound(mesh, surface, holes)) {
        Opening best = best_opening(mesh, surface, seam, holes, progress);
        seam = std::move(best.seam);
        surface = std::move(best.surface);
        length += best.length;
    }
    if (is_too_short(surface)) {
        Cutter cutter(mesh, surface, seam, progress);
        cutter.lengthen();
        length += cutter.length();
        surface = extract_surface(mesh, std::move(surface.face), seam);
    }
    if (cut_length != nullptr)
        *cut_length += length;
    return surface;
}

Index cut_to_tips(const Mesh& mesh, const ChartSurface& disk, std::vector<std::uint8_t>& seam,
                  const TipRule& rule, double& cut_length, const Progress& progress) {
    const Buckets<HalfEdge> edges = inner_half_edges(disk);
    const PathForest by_length = grow_paths(mesh, disk, edges, 0, Measure::length, progress);
    const std::vector<Index> tips = find_tips(mesh, disk, by_length.distance, rule, progress);
    if (tips.empty())
        return 0;
    // A cut that ends at a hole would leave it a contour that does not lie flat.
    if (disk.loops.size() > 1) {
        const ChartSurface open =
            cut_to_disk(mesh, disk, seam, progress, &cut_length, HoleRule::none());
        return cut_to_tips(mesh, open, seam, rule, cut_length, progress);
    }
    const PathForest forest = grow_paths(mesh, disk, edges, 0, Measure::cost, progress);
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
        if (!is_sound(mesh, surfaces[c], options.holes) || is_too_short(surfaces[c]))
            surfaces[c] = cut_to_disk(mesh, std::move(surfaces[c]), result.charts.seam, progress,
                                      &result.cut_length, options.holes);
        if (options.cut_tips)
            result.cut_tips += cut_to_tips(mesh, surfaces[c], result.charts.seam, options.tip_rule,
                                           result.cut_length, progress);
        result.cut_charts += result.cut_length > before ? 1 : 0;
    }
    return result;
}

DiskCuts cut_charts_to_disks(const Mesh& mesh, const ChartMap& charts, Progress& progress) {
    return cut_charts_to_disks(mesh, charts, {false, {}, {}}, progress);
}

} // namespace devseg::atlas
