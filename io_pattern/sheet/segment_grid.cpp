#include "sheet/segment_grid.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"

namespace devseg::sheet {

namespace {

constexpr double most_grid_cells = 1 << 18; // what a grid may take in memory

} // namespace

SegmentGrid::SegmentGrid(const Eigen::AlignedBox2d& box, double cell) : low_(box.min()) {
    const Vec2 size = box.sizes();
    cell_ = std::max(
        {cell, std::sqrt(size.prod() / most_grid_cells), size.maxCoeff() / most_grid_cells});
    columns_ = static_cast<Index>(size.x() / cell_) + 1;
    rows_ = static_cast<Index>(size.y() / cell_) + 1;
    cells_.resize(at(columns_) * at(rows_));
}

template <class Visit>
void SegmentGrid::visit_cells(const Vec2& a, const Vec2& b, Visit visit) const {
    const auto clamped = [&](double place, Index count) {
        return static_cast<Index>(
            std::clamp(std::floor(place / cell_), 0.0, static_cast<double>(count - 1)));
    };
    const Vec2 low = a.cwiseMin(b) - low_;
    const Vec2 high = a.cwiseMax(b) - low_;
    for (Index y = clamped(low.y(), rows_); y <= clamped(high.y(), rows_); ++y)
        for (Index x = clamped(low.x(), columns_); x <= clamped(high.x(), columns_); ++x)
            visit(at(y) * at(columns_) + at(x));
}

void SegmentGrid::add(const Vec2& a, const Vec2& b, Index owner) {
    const Index number = static_cast<Index>(segments_.size());
    segments_.push_back({a, b, owner});
    visit_cells(a, b, [&](std::size_t cell) { cells_[cell].push_back(number); });
}

void SegmentGrid::add_ring(const std::vector<Vec2>& ring, Index owner) {
    for (std::size_t i = 0; i < ring.size(); ++i)
        add(ring[i], ring[(i + 1) % ring.size()], owner);
}

bool SegmentGrid::touches(const Vec2& a, const Vec2& b, Index owner) const {
    bool found = false;
    visit_cells(a, b, [&](std::size_t cell) {
        for (std::size_t i = 0; i < cells_[cell].size() && !found; ++i) {
            const Segment& other = segments_[cells_[cell][i]];
            found = other.owner != owner && plane::segments_touch(a, b, other.a, other.b);
        }
    });
    return found;
}

bool SegmentGrid::ring_touches(const std::vector<Vec2>& ring, Index owner) const {
    for (std::size_t i = 0; i < ring.size(); ++i)
        if (touches(ring[i], ring[(i + 1) % ring.size()], owner))
            return true;
    return false;
}

} // namespace devseg::sheet
