// A flat heap.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace devseg::graph {

/// A 4-ary min-heap of entries with operator<; flatter than a binary one, so fewer cache misses.
template <class Entry_>
class Heap {
public:
    using Entry = Entry_;

    bool empty() const { return entries_.empty(); }
    const Entry& top() const { return entries_.front(); }
    void clear() { entries_.clear(); }

    void push(const Entry& entry) {
        std::size_t hole = entries_.size();
        entries_.push_back(entry);
        for (; hole > 0 && entry < entries_[(hole - 1) / 4]; hole = (hole - 1) / 4)
            entries_[hole] = entries_[(hole - 1) / 4];
        entries_[hole] = entry;
    }

    void pop() {
        const Entry last = entries_.back();
        entries_.pop_back();
        const std::size_t size = entries_.size();
        if (size == 0)
            return;
        std::size_t hole = 0;
        for (std::size_t first = 1; first < size; first = 4 * hole + 1) {
            std::size_t best = first;
            for (std::size_t child = first + 1; child < std::min(first + 4, size); ++child)
                if (entries_[child] < entries_[best])
                    best = child;
            if (!(entries_[best] < last))
                break;
            entries_[hole] = entries_[best];
            hole = best;
        }
        entries_[hole] = last;
    }

private:
    std::vector<Entry> entries_;
};

} // namespace devseg::graph
