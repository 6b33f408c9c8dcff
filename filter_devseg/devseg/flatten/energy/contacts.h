// Pushing parts of a chart apart that overlap in the plane: contacts and their penalty.
//
// References
//   [SS15] J. Smith, S. Schaefer: Bijective Parameterization with Free Boundaries. ACM Transactions
//          on Graphics 34(4), 2015. doi:10.1145/2766947 (there a barrier that starts from a
//          one-to-one map; here a penalty that ends in one, because the start is better)
#pragma once

#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "devseg/atlas/charts.h"

namespace devseg::flatten {

/// A boundary vertex that lies on another part of the chart, and the boundary edge from → to (the
/// chart on its left) across which it leaves that part on the shortest way.
struct Contact {
    Vertex vertex = -1;
    Index from = -1;
    Index to = -1;

    bool operator<(const Contact& o) const {
        return std::tie(vertex, from, to) < std::tie(o.vertex, o.from, o.to);
    }
};

/// Contacts of the given overlapping pairs of faces.
std::vector<Contact> find_contacts(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                                   const std::vector<std::pair<Index, Index>>& pairs);

/// ½ stiffness Σ max(0, d + gap)² with d the distance of the vertex to the left of its edge: zero
/// once each vertex is `gap` outside. Lengths are in the plane.
struct ContactPenalty {
    std::vector<Contact> contacts;
    double stiffness = 0.0;
    double gap = 0.0;

    double energy(const Eigen::MatrixX2d& x) const;
    void add_gradient(const Eigen::MatrixX2d& x, Eigen::MatrixX2d& gradient) const;
};

} // namespace devseg::flatten
