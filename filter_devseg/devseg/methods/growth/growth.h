// Region growing with one queue for each chart [JKS05, section 3.1]; shared by methods that differ
// in the cost of adding a face.
#pragma once

#include <limits>
#include <type_traits>
#include <vector>

#include "devseg/graph/heap.h"
#include "devseg/mesh/mesh.h"

namespace devseg::growth {

/// A face that a chart may take next.
struct Candidate {
    float key;      // cost without the factor that all entries of this chart share
    float distance; // length of the path from the chart's seed
    Index face;

    bool operator<(const Candidate& other) const {
        return key != other.key ? key < other.key : face < other.face; // ties: deterministic
    }
};
using CandidateHeap = graph::Heap<Candidate>;

/// The key of a chart without candidates, above all others: infinity, or a default.
template <class Key>
constexpr Key no_key() {
    if constexpr (std::is_floating_point_v<Key>)
        return std::numeric_limits<Key>::infinity();
    else
        return {};
}

/// Finds the chart with the smallest key among all, after one chart's key changed: O(log n).
template <class Key = float>
class Tournament {
public:
    explicit Tournament(Index players) {
        while (leaves_ < players)
            leaves_ *= 2;
        keys_.assign(at(leaves_), no_key<Key>());
        winner_.assign(at(2 * leaves_), 0);
        for (Index i = 0; i < leaves_; ++i)
            winner_[leaves_ + i] = i;
        for (Index node = leaves_ - 1; node > 0; --node)
            winner_[node] = better(winner_[2 * node], winner_[2 * node + 1]);
    }
    void set(Index player, Key key) {
        keys_[player] = key;
        for (Index node = (leaves_ + player) / 2; node > 0; node /= 2)
            winner_[node] = better(winner_[2 * node], winner_[2 * node + 1]);
    }
    Index winner() const { return winner_[1]; }
    const Key& key(Index player) const { return keys_[player]; }

private:
    Index better(Index a, Index b) const {
        return keys_[b] < keys_[a] ? b : a; // ties: the lower number, which is a
    }
    Index leaves_ = 1;
    std::vector<Key> keys_;
    std::vector<Index> winner_;
};

} // namespace devseg::growth
