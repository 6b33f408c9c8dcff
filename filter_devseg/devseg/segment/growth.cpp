#include "devseg/segment/growth.h"

#include <algorithm>

namespace devseg {

void CandidateHeap::push(const Entry& entry) {
    std::size_t hole = entries_.size();
    entries_.push_back(entry);
    while (hole > 0) {
        const std::size_t parent = (hole - 1) / 4;
        if (!before(entry, entries_[parent]))
            break;
        entries_[hole] = entries_[parent];
        hole = parent;
    }
    entries_[hole] = entry;
}

void CandidateHeap::pop() {
    const Entry last = entries_.back();
    entries_.pop_back();
    const std::size_t size = entries_.size();
    if (size == 0)
        return;
    std::size_t hole = 0;
    while (true) {
        const std::size_t first = 4 * hole + 1;
        if (first >= size)
            break;
        std::size_t best = first;
        for (std::size_t child = first + 1; child < std::min(first + 4, size); ++child)
            if (before(entries_[child], entries_[best]))
                best = child;
        if (!before(entries_[best], last))
            break;
        entries_[hole] = entries_[best];
        hole = best;
    }
    entries_[hole] = last;
}

Tournament::Tournament(Index players) {
    while (leaves_ < players)
        leaves_ *= 2;
    keys_.assign(at(leaves_), std::numeric_limits<float>::infinity());
    winner_.assign(at(2 * leaves_), 0);
    for (Index i = 0; i < leaves_; ++i)
        winner_[at(leaves_ + i)] = i;
    for (Index node = leaves_ - 1; node > 0; --node)
        winner_[at(node)] = better(winner_[at(2 * node)], winner_[at(2 * node + 1)]);
}

void Tournament::set(Index player, float key) {
    keys_[at(player)] = key;
    for (Index node = (leaves_ + player) / 2; node > 0; node /= 2)
        winner_[at(node)] = better(winner_[at(2 * node)], winner_[at(2 * node + 1)]);
}

} // namespace devseg
