// The shortest cut that separates two sets of faces.
//
// References
//   E. A. Dinic: Algorithm for Solution of a Problem of Maximum Flow in Networks with Power
//   Estimation. Soviet Mathematics Doklady 11, 1970.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/numbers.h"
#include "devseg/base/progress.h"

namespace devseg::graph {

enum class CutSide : std::uint8_t { open, source, sink };

/// Decides every open node such that the links between the two sides have the least total weight
/// (minimum cut by maximum flow). Nodes are faces or any other numbers 0 … n − 1.
class MinCut {
public:
    explicit MinCut(std::vector<CutSide> sides) : sides_(std::move(sides)) {}

    /// Two nodes that cost `weight` ≥ 0 to separate. Returns the number of the link. Links may be
    /// added and raised between two calls of solve, which goes on from the flow that it has found.
    Index link(Index a, Index b, double weight);
    void raise(Index link, double weight);

    /// All sides; open nodes that no source reaches without a saturated link become sinks.
    std::vector<CutSide> solve(const Progress& progress = Progress());

private:
    struct Arc {
        Index to;
        Index partner; // the arc back
        double capacity;
    };
    void sort_new_arcs();
    bool rank_nodes();
    void push(Index source);

    std::vector<CutSide> sides_;
    std::vector<Arc> added_;   // since the last call of solve; arcs i and i ^ 1 are a pair
    std::vector<Arc> arcs_;    // of node v: begin_[v] … begin_[v + 1] − 1
    std::vector<Index> begin_; // #nodes + 1
    std::vector<Index> arc_;   // of each link
    std::vector<Index> rank_;
    std::vector<Index> cursor_;
    std::vector<Index> path_; // arcs of the path at hand
    double saturated_ = 0.0;  // a rest of capacity below this is rounding
};

} // namespace devseg::graph
