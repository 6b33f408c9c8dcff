// Boxes in the plane, sorted into the cells of a grid.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "devseg/base/numbers.h"

namespace devseg::plane {

/// Finds which of many boxes touch a box, or have a point in them, without a look at all of them.
class BoxGrid {
public:
    /// A grid for these boxes, with as many cells as there are boxes. None is in it yet.
    explicit BoxGrid(const std::vector<Eigen::AlignedBox2d>& boxes);

    void add(Index box);

    /// Whether `is_it(b)` holds for a box b of those added that touches the given one. It may be
    /// asked more than once.
    template <class Test>
    bool any_touching(const Eigen::AlignedBox2d& box, Test is_it) const {
        const Cells range = cells_of(box);
        for (Index y = range.low[1]; y <= range.high[1]; ++y)
            for (Index x = range.low[0]; x <= range.high[0]; ++x)
                for (const Index b : cells_[at(y * side_ + x)])
                    if (!boxes_[at(b)].intersection(box).isEmpty() && is_it(b))
                        return true;
        return false;
    }

private:
    struct Cells {
        Index low[2];
        Index high[2];
    };
    Cells cells_of(const Eigen::AlignedBox2d& box) const;

    const std::vector<Eigen::AlignedBox2d>& boxes_;
    Eigen::AlignedBox2d extent_;
    Index side_; // cells along each axis
    std::vector<std::vector<Index>> cells_;
};

} // namespace devseg::plane
