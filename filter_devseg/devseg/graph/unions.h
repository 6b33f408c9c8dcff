// Sets that are joined: which of them is an item in?
#pragma once

#include <numeric>
#include <vector>

#include "devseg/base/numbers.h"

namespace devseg::graph {

class Unions {
public:
    explicit Unions(std::size_t items) : parent_(items) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    /// The item that stands for the set of i.
    Index find(Index i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// The set of `other` becomes part of that of `into`; both stand for theirs.
    void join(Index into, Index other) { parent_[other] = into; }

private:
    std::vector<Index> parent_;
};

} // namespace devseg::graph
