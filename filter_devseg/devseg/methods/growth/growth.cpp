#include "devseg/methods/growth/growth.h"

#include <algorithm>

namespace devseg::growth {

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

} // namespace devseg::growth
