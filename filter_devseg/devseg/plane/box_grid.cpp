#include "devseg/plane/box_grid.h"

#include <algorithm>
#include <cmath>

namespace devseg::plane {

BoxGrid::BoxGrid(const std::vector<Eigen::AlignedBox2d>& boxes) : boxes_(boxes) {
    for (const Eigen::AlignedBox2d& box : boxes)
        extent_.extend(box);
    side_ = std::max<Index>(1, static_cast<Index>(std::sqrt(static_cast<double>(boxes.size()))));
    cells_.resize(at(side_) * at(side_));
}

void BoxGrid::add(Index box) {
    const Cells range = cells_of(boxes_[at(box)]);
    for (Index y = range.low[1]; y <= range.high[1]; ++y)
        for (Index x = range.low[0]; x <= range.high[0]; ++x)
            cells_[at(y * side_ + x)].push_back(box);
}

// What lies beside the grid belongs to its outermost cells.
BoxGrid::Cells BoxGrid::cells_of(const Eigen::AlignedBox2d& box) const {
    Cells range;
    for (const int axis : {0, 1}) {
        const double size = extent_.sizes()[axis];
        const auto cell = [&](double place) {
            const double share = size > 0.0 ? (place - extent_.min()[axis]) / size : 0.0;
            return static_cast<Index>(std::clamp(share * side_, 0.0, side_ - 1.0));
        };
        range.low[axis] = cell(box.min()[axis]);
        range.high[axis] = cell(box.max()[axis]);
    }
    return range;
}

} // namespace devseg::plane
