#include "sheet/segment_grid.h"

#include <algorithm>
#include <cmath>

namespace devseg::sheet {

namespace {

constexpr double most_cells = 1 << 18; // what a grid may take in memory

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    const Vec2 u = b - a;
    const Vec2 v = c - a;
    return u.x() * v.y() - u.y() * v.x();
}

// Whether c, known to lie on the line through a and b, is between them.
bool is_between(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (c - a).dot(c - b) <= 0.0;
}

} // namespace

bool segments_touch(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const double c_side = turn(a, b, c);
    const double d_side = turn(a, b, d);
    const double a_side = turn(c, d, a);
    const double b_side = turn(c, d, b);
    if (((c_side > 0.0 && d_side < 0.0) || (c_side < 0.0 && d_side > 0.0)) &&
        ((a_side > 0.0 && b_side < 0.0) || (a_side < 0.0 && b_side > 0.0)))
        return true;
    return (c_side == 0.0 && is_between(a, b, c)) || (d_side == 0.0 && is_between(a, b, d)) ||
           (a_side == 0.0 && is_between(c, d, a)) || (b_side == 0.0 && is_between(c, d, b));
}

bool is_inside(const std::vector<Vec2>& ring, const Vec2& p) {
    bool inside = false;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        const Vec2& a = ring[i];
        const Vec2& b = ring[j];
        if ((a.y() > p.y()) != (b.y() > p.y()) &&
            p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
            inside = !inside;
    }
    return inside;
}

bool is_inside(const std::vector<std::vector<Vec2>>& rings, const Vec2& p) {
    bool inside = false;
    for (const std::vector<Vec2>& ring : rings)
        inside = inside != is_inside(ring, p);
    return inside;
}

SegmentGrid::SegmentGrid(const Eigen::AlignedBox2d& box, double cell) : low_(box.min()) {
    const Vec2 size = box.sizes();
    cell_ = std::max({cell, std::sqrt(size.prod() / most_cells), size.maxCoeff() / most_cells});
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
        for (const Index number : cells_[cell]) {
            const Segment& other = segments_[number];
            found = found || (other.owner != owner && segments_touch(a, b, other.a, other.b));
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
