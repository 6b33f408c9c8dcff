#include "devseg/atlas/join_loops.h"

#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/graph/shortest_paths.h"

namespace devseg::atlas {

Buckets<HalfEdge> inner_half_edges(const ChartSurface& surface) {
    return make_buckets<HalfEdge>(surface.vertex_count(), [&](auto put) {
        for (const HalfEdge h : surface.all_half_edges())
            if (surface.twin[h] >= 0)
                put(surface.origin(h), h);
    });
}

double loop_length(const Mesh& mesh, const ChartSurface& surface, const std::vector<Index>& loop) {
    double sum = 0.0;
    for (const HalfEdge h : loop)
        sum += mesh.edge_length(surface.mesh_half_edge(h));
    return sum;
}

namespace {

class LoopJoiner {
public:
    LoopJoiner(const Mesh& mesh, const ChartSurface& surface, std::vector<std::uint8_t> kept)
        : mesh_(mesh), s_(surface), kept_(std::move(kept)), edges_(inner_half_edges(surface)),
          paths_(surface.vertex.size()), open_loop_(surface.vertex.size(), -1),
          along_hole_(surface.vertex.size(), -1) {
        kept_.resize(s_.loops.size(), 0);
        for (std::size_t l = 0; l < s_.loops.size(); ++l)
            for (const HalfEdge h : s_.loops[l]) {
                if (kept_[l] != 0)
                    along_hole_[s_.target(h)] = h;
                else
                    open_loop_[s_.origin(h)] = static_cast<Index>(l);
            }
    }

    std::vector<Index> run(const Progress& progress) {
        std::size_t longest = 0;
        double length = -1.0;
        std::ptrdiff_t open = 0;
        for (std::size_t l = 0; l < s_.loops.size(); ++l) {
            if (kept_[l] != 0)
                continue;
            ++open;
            const double own = loop_length(mesh_, s_, s_.loops[l]);
            if (own > length) {
                longest = l;
                length = own;
            }
        }
        if (open < 2)
            return {};
        absorb_loop(static_cast<Index>(longest));
        --open;
        paths_.run(
            [&](Vertex v, double distance) {
                if (open_loop_[v] >= 0) {
                    const Index loop = open_loop_[v];
                    absorb_path(v);
                    absorb_loop(loop);
                    return --open > 0;
                }
                // Along the contour of a hole nothing has to be cut.
                if (along_hole_[v] >= 0)
                    paths_.reach(s_.origin(along_hole_[v]), distance, along_hole_[v]);
                for (const HalfEdge e : edges_[v])
                    paths_.reach(s_.target(e), distance + cut_cost(mesh_, s_.mesh_half_edge(e)),
                                 s_.twin[e]);
                return true;
            },
            progress);
        return std::move(cut_);
    }

private:
    void absorb_loop(Index loop) {
        for (const HalfEdge h : s_.loops[loop]) {
            open_loop_[s_.origin(h)] = -1;
            paths_.add_source(s_.origin(h));
        }
    }
    // The path from v to what is joined already is cut, and is joined from now on.
    void absorb_path(Vertex v) {
        while (paths_.step[v] >= 0) {
            const HalfEdge h = paths_.step[v];
            if (s_.twin[h] >= 0)
                cut_.push_back(h);
            paths_.add_source(v);
            v = s_.target(h);
        }
    }

    const Mesh& mesh_;
    const ChartSurface& s_;
    std::vector<std::uint8_t> kept_; // #loops
    Buckets<HalfEdge> edges_;
    graph::ShortestPaths<> paths_;     // to what is joined; steps leave the vertex, towards it
    std::vector<Index> open_loop_;     // #v: loop of the vertex that is not joined yet, −1 = none
    std::vector<HalfEdge> along_hole_; // #v: the half-edge into it along a kept loop, −1 = none
    std::vector<Index> cut_;
};

} // namespace

std::vector<Index> join_loops(const Mesh& mesh, const ChartSurface& surface,
                              const std::vector<std::uint8_t>& kept, const Progress& progress) {
    return LoopJoiner(mesh, surface, kept).run(progress);
}

} // namespace devseg::atlas
