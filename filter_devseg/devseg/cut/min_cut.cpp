#include "devseg/cut/min_cut.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace devseg {

namespace {
constexpr double rounding = 1e-12; // of the largest weight
}

Index MinCut::link(Index a, Index b, double weight) {
    arcs_.push_back({b, weight});
    arcs_.push_back({a, weight});
    saturated_ = std::max(saturated_, rounding * weight);
    built_ = false;
    return static_cast<Index>(arcs_.size() / 2) - 1;
}

void MinCut::raise(Index link, double weight) {
    arcs_[2 * at(link)].capacity += weight;
    arcs_[2 * at(link) + 1].capacity += weight;
    saturated_ = std::max(saturated_, rounding * arcs_[2 * at(link)].capacity);
}

void MinCut::build() {
    begin_.assign(sides_.size() + 1, 0);
    // Arc i leaves the node that its partner points to.
    const auto from = [&](std::size_t i) { return arcs_[i ^ 1].to; };
    for (std::size_t i = 0; i < arcs_.size(); ++i)
        ++begin_[at(from(i)) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    order_.resize(arcs_.size());
    std::vector<Index> place(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < arcs_.size(); ++i)
        order_[at(place[at(from(i))]++)] = static_cast<Index>(i);
    built_ = true;
}

// Breadth-first distance from the sources; true if a sink is reached.
bool MinCut::rank_nodes() {
    rank_.assign(sides_.size(), -1);
    std::vector<Index> queue;
    for (std::size_t v = 0; v < sides_.size(); ++v)
        if (sides_[v] == CutSide::source) {
            rank_[v] = 0;
            queue.push_back(static_cast<Index>(v));
        }
    bool reached = false;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Index v = queue[i];
        for (Index k = begin_[at(v)]; k < begin_[at(v) + 1]; ++k) {
            const Arc& arc = arcs_[at(order_[at(k)])];
            if (!(arc.capacity > saturated_) || rank_[at(arc.to)] >= 0)
                continue;
            rank_[at(arc.to)] = rank_[at(v)] + 1;
            reached = reached || sides_[at(arc.to)] == CutSide::sink;
            if (sides_[at(arc.to)] != CutSide::sink)
                queue.push_back(arc.to);
        }
    }
    return reached;
}

// Sends flow from `source` along increasing ranks until none arrives any more. Written with a stack
// of its own, because paths are as long as meshes are large.
void MinCut::push(Index source) {
    path_.clear();
    Index v = source;
    while (true) {
        if (sides_[at(v)] == CutSide::sink) {
            double flow = std::numeric_limits<double>::max();
            for (const Index i : path_)
                flow = std::min(flow, arcs_[at(i)].capacity);
            std::size_t first_full = path_.size();
            for (std::size_t k = path_.size(); k-- > 0;) {
                arcs_[at(path_[k])].capacity -= flow;
                arcs_[at(path_[k] ^ 1)].capacity += flow;
                if (arcs_[at(path_[k])].capacity <= saturated_)
                    first_full = k;
            }
            // The path up to its first full arc serves again.
            v = arcs_[at(path_[first_full] ^ 1)].to;
            path_.resize(first_full);
        }
        Index& k = cursor_[at(v)];
        while (k < begin_[at(v) + 1]) {
            const Arc& arc = arcs_[at(order_[at(k)])];
            if (arc.capacity > saturated_ && rank_[at(arc.to)] == rank_[at(v)] + 1)
                break;
            ++k;
        }
        if (k < begin_[at(v) + 1]) {
            path_.push_back(order_[at(k)]);
            v = arcs_[at(path_.back())].to;
            continue;
        }
        if (path_.empty())
            return;
        // A dead end: step back, and do not come here again.
        v = arcs_[at(path_.back() ^ 1)].to;
        ++cursor_[at(v)];
        path_.pop_back();
    }
}

std::vector<CutSide> MinCut::solve() {
    if (!built_)
        build();
    while (rank_nodes()) {
        cursor_.assign(begin_.begin(), begin_.end() - 1);
        for (std::size_t v = 0; v < sides_.size(); ++v)
            if (sides_[v] == CutSide::source)
                push(static_cast<Index>(v));
    }
    std::vector<CutSide> result = sides_;
    for (std::size_t v = 0; v < result.size(); ++v)
        if (result[v] == CutSide::open)
            result[v] = rank_[v] >= 0 ? CutSide::source : CutSide::sink;
    return result;
}

} // namespace devseg
