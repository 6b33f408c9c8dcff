#include "devseg/atlas/join_loops.h"

#include <utility>

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

struct Tuning {
    // What an edge between two faces of one plane (normals within 1e-3 rad) costs to cut, over one
    // on a fold: a person would cut around a flat face.
    double through_flat = 10.0;
    double flat_cosine = 1.0 - 0.5e-6;
};
constexpr Tuning tuning;

class LoopJoiner {
public:
    LoopJoiner(const Mesh& mesh, const ChartSurface& surface)
        : mesh_(mesh), s_(surface), edges_(inner_half_edges(surface)),
          paths_(surface.vertex.size()), open_loop_(surface.vertex.size(), -1) {
        for (std::size_t l = 0; l < s_.loops.size(); ++l)
            for (const HalfEdge h : s_.loops[l])
                open_loop_[s_.origin(h)] = static_cast<Index>(l);
    }

    std::vector<Index> run(const Progress& progress) {
        std::size_t longest = 0;
        for (std::size_t l = 1; l < s_.loops.size(); ++l)
            if (loop_length(mesh_, s_, s_.loops[l]) > loop_length(mesh_, s_, s_.loops[longest]))
                longest = l;
        absorb_loop(static_cast<Index>(longest));
        std::size_t open = s_.loops.size() - 1;
        paths_.run(
            [&](Vertex v, double distance) {
                if (open_loop_[v] >= 0) {
                    const Index loop = open_loop_[v];
                    absorb_path(v);
                    absorb_loop(loop);
                    return --open > 0;
                }
                for (const HalfEdge e : edges_[v])
                    paths_.reach(s_.target(e), distance + cost(s_.mesh_half_edge(e)), s_.twin[e]);
                return true;
            },
            progress);
        return std::move(cut_);
    }

private:
    double cost(HalfEdge h) const {
        const double cosine =
            mesh_.face_normals[face_of(h)].dot(mesh_.face_normals[mesh_.across(h)]);
        return mesh_.edge_length(h) * (cosine >= tuning.flat_cosine ? tuning.through_flat : 1.0);
    }

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
            cut_.push_back(h);
            paths_.add_source(v);
            v = s_.target(h);
        }
    }

    const Mesh& mesh_;
    const ChartSurface& s_;
    Buckets<HalfEdge> edges_;
    graph::ShortestPaths<> paths_; // to what is joined; steps leave the vertex, towards it
    std::vector<Index> open_loop_; // #v: loop of the vertex that is not joined yet, −1 = none
    std::vector<Index> cut_;
};

} // namespace

std::vector<Index> join_loops(const Mesh& mesh, const ChartSurface& surface,
                              const Progress& progress) {
    return LoopJoiner(mesh, surface).run(progress);
}

} // namespace devseg::atlas
