// Nearest points, by a hierarchy of boxes.
#pragma once

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <unsupported/Eigen/BVH>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

class NearestPoints {
public:
    explicit NearestPoints(const std::vector<Vec3>& points) : points_(points) {
        std::vector<Index> order(points.size());
        std::iota(order.begin(), order.end(), 0);
        std::vector<Eigen::AlignedBox3d> boxes;
        for (const Vec3& p : points)
            boxes.emplace_back(p);
        tree_.init(order.begin(), order.end(), boxes.begin(), boxes.end());
    }

    /// The nearest point that is nearer than `reach` and for which accept(i) holds; of equally near
    /// ones the first; −1 = none.
    template <class Accept>
    Index nearest(const Vec3& p, Accept accept, double reach = infinite) const {
        Search<Accept> search{points_, p, accept, reach * reach};
        if (!points_.empty())
            Eigen::BVMinimize(tree_, search);
        return search.best;
    }

private:
    template <class Accept>
    struct Search {
        using Scalar = double;

        const std::vector<Vec3>& points;
        const Vec3& p;
        const Accept& accept;
        double least;
        Index best = -1;

        double minimumOnVolume(const Eigen::AlignedBox3d& box) const {
            return box.squaredExteriorDistance(p);
        }
        double minimumOnObject(Index i) {
            const double d = (points[i] - p).squaredNorm();
            if ((d < least || (d == least && i < best)) && accept(i)) {
                least = d;
                best = i;
            }
            return std::nextafter(least, infinite); // so that equally near points are looked at
        }
    };

    const std::vector<Vec3>& points_;
    Eigen::KdBVH<double, 3, Index> tree_;
};

} // namespace devseg::mesh
