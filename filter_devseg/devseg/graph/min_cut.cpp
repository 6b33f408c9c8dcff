#include "devseg/graph/min_cut.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace devseg::graph {

namespace {
constexpr double rounding = 1e-12; // of the largest weight
}

Index MinCut::link(Index a, Index b, double weight) {
    const Index last = static_cast<Index>(added_.size());
    added_.push_back({b, last + 1, weight});
    added_.push_back({a, last, weight});
    saturated_ = std::max(saturated_, rounding * weight);
    arc_.push_back(-1);
    return static_cast<Index>(arc_.size()) - 1;
}

void MinCut::raise(Index link, double weight) {
    const std::size_t new_arcs = added_.size();
    const std::size_t old_links = arc_.size() - new_arcs / 2;
    std::vector<Arc>& arcs = at(link) < old_links ? arcs_ : added_;
    Arc& arc = arcs[at(link) < old_links ? at(arc_[link]) : 2 * (at(link) - old_links)];
    arc.capacity += weight;
    arcs[arc.partner].capacity += weight;
    saturated_ = std::max(saturated_, rounding * arc.capacity);
}

// Arcs of one node lie side by side: paths are searched many times.
void MinCut::sort_new_arcs() {
    const std::vector<Arc> old = std::move(arcs_);
    const std::vector<Index> old_begin = std::move(begin_);
    const auto old_count = [&](std::size_t v) {
        return old.empty() ? 0 : old_begin[v + 1] - old_begin[v];
    };
    begin_.assign(sides_.size() + 1, 0);
    for (const Arc& arc : added_)
        ++begin_[at(added_[arc.partner].to) + 1];
    for (std::size_t v = 0; v < sides_.size(); ++v)
        begin_[v + 1] += begin_[v] + old_count(v);
    arcs_.resize(old.size() + added_.size());
    std::vector<Index> place(begin_.begin(), begin_.end() - 1);
    std::vector<Index> moved(old.size()); // new places of the arcs that were there
    for (std::size_t v = 0; v < sides_.size(); ++v)
        for (Index k = 0; k < old_count(v); ++k)
            moved[old_begin[v] + k] = place[v]++;
    for (std::size_t i = 0; i < old.size(); ++i)
        arcs_[moved[i]] = {old[i].to, moved[old[i].partner], old[i].capacity};
    const std::size_t old_links = arc_.size() - added_.size() / 2;
    for (std::size_t k = 0; k < old_links; ++k)
        arc_[k] = moved[arc_[k]];
    for (std::size_t i = 0; i < added_.size(); i += 2) {
        const Index there = place[added_[i + 1].to]++;
        const Index back = place[added_[i].to]++;
        arcs_[there] = {added_[i].to, back, added_[i].capacity};
        arcs_[back] = {added_[i + 1].to, there, added_[i + 1].capacity};
        arc_[old_links + i / 2] = there;
    }
    added_.clear();
}

// Breadth-first distance from the sources; true if a sink is reached. Nodes that are farther away
// than the first sink have no rank then: no shortest path goes through them.
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
        for (Index k = begin_[v]; k < begin_[at(v) + 1]; ++k) {
            const Arc& arc = arcs_[k];
            if (!(arc.capacity > saturated_) || rank_[arc.to] >= 0)
                continue;
            const bool is_sink = sides_[arc.to] == CutSide::sink;
            if (reached && !is_sink)
                continue;
            rank_[arc.to] = rank_[v] + 1;
            reached = reached || is_sink;
            if (!is_sink)
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
        if (sides_[v] == CutSide::sink) {
            double flow = std::numeric_limits<double>::max();
            for (const Index i : path_)
                flow = std::min(flow, arcs_[i].capacity);
            std::size_t first_full = path_.size();
            for (std::size_t k = path_.size(); k-- > 0;) {
                arcs_[path_[k]].capacity -= flow;
                arcs_[arcs_[path_[k]].partner].capacity += flow;
                if (arcs_[path_[k]].capacity <= saturated_)
                    first_full = k;
            }
            // The path up to its first full arc serves again.
            v = arcs_[arcs_[path_[first_full]].partner].to;
            path_.resize(first_full);
        }
        Index& k = cursor_[v];
        while (k < begin_[at(v) + 1]) {
            const Arc& arc = arcs_[k];
            if (arc.capacity > saturated_ && rank_[arc.to] == rank_[v] + 1)
                break;
            ++k;
        }
        if (k < begin_[at(v) + 1]) {
            path_.push_back(k);
            v = arcs_[path_.back()].to;
            continue;
        }
        if (path_.empty())
            return;
        // A dead end: step back, and do not come here again.
        v = arcs_[arcs_[path_.back()].partner].to;
        ++cursor_[v];
        path_.pop_back();
    }
}

std::vector<CutSide> MinCut::solve(const Progress& progress) {
    if (!added_.empty() || begin_.empty())
        sort_new_arcs();
    while (rank_nodes()) {
        progress.check();
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

} // namespace devseg::graph
