// Segments in the plane, found by place.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "devseg/mesh/mesh.h"

namespace devseg::sheet {

class SegmentGrid {
public:
    /// For segments that lie in the box for the most part; others are found as well.
    SegmentGrid(const Eigen::AlignedBox2d& box, double cell);

    /// `owner`: any number, for the caller.
    void add(const Vec2& a, const Vec2& b, Index owner);
    void add_ring(const std::vector<Vec2>& ring, Index owner);

    /// Whether the segment touches one of another owner.
    bool touches(const Vec2& a, const Vec2& b, Index owner) const;
    bool ring_touches(const std::vector<Vec2>& ring, Index owner) const;

private:
    struct Segment {
        Vec2 a;
        Vec2 b;
        Index owner;
    };
    template <class Visit>
    void visit_cells(const Vec2& a, const Vec2& b, Visit visit) const;

    Vec2 low_;
    double cell_;
    Index columns_;
    Index rows_;
    std::vector<Segment> segments_;
    std::vector<std::vector<Index>> cells_;
};

} // namespace devseg::sheet
