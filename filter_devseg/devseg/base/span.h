// A part of an array.
#pragma once

#include <vector>

#include "devseg/base/numbers.h"

namespace devseg {

/// Elements first … end − 1 of an array that outlives it, for range-based loops.
template <class T>
class Span {
public:
    Span(const std::vector<T>& array, Index first, Index end)
        : begin_(array.data() + first), end_(array.data() + end) {}
    const T* begin() const { return begin_; }
    const T* end() const { return end_; }
    std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }

private:
    const T* begin_;
    const T* end_;
};

} // namespace devseg
