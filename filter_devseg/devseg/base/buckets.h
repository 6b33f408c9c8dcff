// Items sorted into buckets.
#pragma once

#include <numeric>
#include <vector>

#include "devseg/base/span.h"

namespace devseg {

/// Those of bucket b are buckets[b], in the order in which they came.
template <class Item>
struct Buckets {
    std::vector<Index> begin; // #buckets + 1
    std::vector<Item> items;

    Index count() const { return static_cast<Index>(begin.size()) - 1; }
    Span<Item> operator[](Index b) const { return {items, begin[at(b)], begin[at(b) + 1]}; }
};

/// visit(put) calls put(bucket, item) for all items, and is called twice: to count, and to fill.
template <class Item, class Visit>
Buckets<Item> make_buckets(Index count, Visit visit) {
    Buckets<Item> result;
    result.begin.assign(at(count) + 1, 0);
    visit([&](Index b, const Item&) { ++result.begin[at(b) + 1]; });
    std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
    result.items.resize(at(result.begin.back()));
    std::vector<Index> cursor(result.begin.begin(), result.begin.end() - 1);
    visit([&](Index b, const Item& item) { result.items[at(cursor[at(b)]++)] = item; });
    return result;
}

} // namespace devseg
