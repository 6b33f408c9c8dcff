#include "devseg/atlas/join_loops.h"

#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

namespace devseg::atlas {

VertexEdges::VertexEdges(const ChartSurface& surface) : begin_(at(surface.vertex_count()) + 1, 0) {
    const auto each = [&](auto visit) {
        for (const HalfEdge h : surface.all_half_edges()) {
            visit(surface.origin(h), h);
            if (surface.twin[h] < 0)
                visit(surface.target(h), h);
        }
    };
    each([&](Vertex v, Index) { ++begin_[at(v) + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    edges_.resize(at(begin_.back()));
    std::vector<Index> cursor(begin_.begin(), begin_.end() - 1);
    each([&](Vertex v, HalfEdge h) { edges_[cursor[v]++] = h; });
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
    LoopJoiner(const Mesh& mesh, const ChartSurface& surface)
        : mesh_(mesh), s_(surface), edges_(surface), distance_(surface.vertex.size(), infinite),
          toward_(surface.vertex.size(), -1), open_loop_(surface.vertex.size(), -1) {
        for (std::size_t l = 0; l < s_.loops.size(); ++l)
            for (const HalfEdge h : s_.loops[l])
                open_loop_[s_.origin(h)] = static_cast<Index>(l);
    }

    std::vector<Index> run(const Progress& progress) {
        Heartbeat beat(progress);
        std::size_t longest = 0;
        for (std::size_t l = 1; l < s_.loops.size(); ++l)
            if (loop_length(mesh_, s_, s_.loops[l]) > loop_length(mesh_, s_, s_.loops[longest]))
                longest = l;
        absorb_loop(static_cast<Index>(longest));
        for (std::size_t open = s_.loops.size() - 1; open > 0 && !queue_.empty();) {
            beat();
            const auto [d, v] = queue_.top();
            queue_.pop();
            if (d > distance_[v])
                continue;
            if (open_loop_[v] >= 0) {
                const Index loop = open_loop_[v];
                absorb_path(v);
                absorb_loop(loop);
                --open;
            } else {
                relax(v);
            }
        }
        return std::move(cut_);
    }

private:
    void make_source(Vertex v) {
        distance_[v] = 0.0;
        toward_[v] = -1;
        queue_.emplace(0.0, v);
    }
    void absorb_loop(Index loop) {
        for (const HalfEdge h : s_.loops[loop]) {
            open_loop_[s_.origin(h)] = -1;
            make_source(s_.origin(h));
        }
    }
    // The path from v to what is joined already is cut, and is joined from now on.
    void absorb_path(Vertex v) {
        while (toward_[v] >= 0) {
            const HalfEdge h = toward_[v];
            cut_.push_back(h);
            make_source(v);
            v = s_.target(h);
        }
    }
    void relax(Vertex v) {
        for (const Index* e = edges_.first(v); e != edges_.last(v); ++e) {
            if (s_.twin[*e] < 0)
                continue;
            const Index w = s_.target(*e);
            const double through = distance_[v] + mesh_.edge_length(s_.mesh_half_edge(*e));
            if (through < distance_[w]) {
                distance_[w] = through;
                toward_[w] = s_.twin[*e];
                queue_.emplace(through, w);
            }
        }
    }

    using Entry = std::pair<double, Index>;
    const Mesh& mesh_;
    const ChartSurface& s_;
    VertexEdges edges_;
    std::vector<double> distance_; // #v: to what is joined
    std::vector<Index> toward_;    // #v: half-edge from the vertex, one step nearer
    std::vector<Index> open_loop_; // #v: loop of the vertex that is not joined yet, −1 = none
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
    std::vector<Index> cut_;
};

} // namespace

std::vector<Index> join_loops(const Mesh& mesh, const ChartSurface& surface,
                              const Progress& progress) {
    return LoopJoiner(mesh, surface).run(progress);
}

} // namespace devseg::atlas
