// Nearest points by a uniform grid.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg {

/// Buckets of points over a grid whose cells hold about two points of a surface each.
class PointGrid {
public:
    explicit PointGrid(const std::vector<Vec3>& points) : points_(points) {
        for (const Vec3& p : points)
            box_.extend(p);
        const Vec3 size = box_.sizes().cwiseMax(1e-12 * std::max(1e-300, box_.sizes().maxCoeff()));
        const double area = 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
        cell_ = std::max(std::sqrt(2.0 * area / static_cast<double>(points.size())),
                         size.maxCoeff() / most_cells);
        for (int k = 0; k < 3; ++k)
            count_[static_cast<std::size_t>(k)] = 1 + static_cast<Index>(size[k] / cell_);
        begin_.assign(at(count_[0]) * at(count_[1]) * at(count_[2]) + 1, 0);
        for (const Vec3& p : points)
            ++begin_[place(cell_of(p)) + 1];
        for (std::size_t i = 1; i < begin_.size(); ++i)
            begin_[i] += begin_[i - 1];
        order_.resize(points.size());
        std::vector<Index> cursor(begin_.begin(), begin_.end() - 1);
        for (std::size_t i = 0; i < points.size(); ++i)
            order_[at(cursor[place(cell_of(points[i]))]++)] = static_cast<Index>(i);
    }

    /// The nearest point for which accept(i) holds; of equally near ones the first; −1 = none.
    template <class Accept>
    Index nearest(const Vec3& p, Accept accept) const {
        const Triangle center = cell_of(p);
        const Index most = *std::max_element(count_.begin(), count_.end());
        Index best = -1;
        double least = std::numeric_limits<double>::infinity();
        for (Index ring = 0; ring <= most; ++ring) {
            // Points beyond this ring are at least so far away.
            const double reached = (ring - 1) * cell_ - outside(p);
            if (best >= 0 && reached > 0.0 && reached * reached > least)
                break;
            visit_ring(center, ring, [&](std::size_t bucket) {
                for (Index k = begin_[bucket]; k < begin_[bucket + 1]; ++k) {
                    const Index i = order_[at(k)];
                    const double d = (points_[at(i)] - p).squaredNorm();
                    if ((d < least || (d == least && i < best)) && accept(i)) {
                        least = d;
                        best = i;
                    }
                }
            });
        }
        return best;
    }

private:
    static constexpr double most_cells = 128.0; // along one axis

    double outside(const Vec3& p) const { return std::sqrt(box_.squaredExteriorDistance(p)); }
    Triangle cell_of(const Vec3& p) const {
        Triangle cell{};
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<std::size_t>(k);
            const double x =
                std::clamp((p[k] - box_.min()[k]) / cell_, 0.0, static_cast<double>(count_[i] - 1));
            cell[i] = static_cast<Index>(x);
        }
        return cell;
    }
    std::size_t place(const Triangle& c) const {
        return (at(c[2]) * at(count_[1]) + at(c[1])) * at(count_[0]) + at(c[0]);
    }
    template <class Visit>
    void visit_ring(const Triangle& c, Index ring, Visit visit) const {
        const auto low = [&](std::size_t k) { return std::max<Index>(0, c[k] - ring); };
        const auto high = [&](std::size_t k) { return std::min(count_[k] - 1, c[k] + ring); };
        for (Index z = low(2); z <= high(2); ++z)
            for (Index y = low(1); y <= high(1); ++y)
                for (Index x = low(0); x <= high(0); ++x)
                    if (std::max({std::abs(x - c[0]), std::abs(y - c[1]), std::abs(z - c[2])}) ==
                        ring)
                        visit(place({x, y, z}));
    }

    const std::vector<Vec3>& points_;
    Eigen::AlignedBox3d box_;
    double cell_ = 1.0;
    Triangle count_{1, 1, 1};
    std::vector<Index> begin_;
    std::vector<Index> order_;
};

} // namespace devseg
