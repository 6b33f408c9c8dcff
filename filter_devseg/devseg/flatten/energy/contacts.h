// Boundary vertices of a map that lie on another part of it, and what pushes them out.
#pragma once

#include <tuple>
#include <vector>

#include "devseg/flatten/energy/distortion.h"

namespace devseg::flatten {

/// A boundary vertex that lies on another part of the chart, and the boundary edge from → to (the
/// chart on its left) across which it leaves that part on the shortest way.
struct Contact {
    Vertex vertex = -1;
    Vertex from = -1;
    Vertex to = -1;

    bool operator<(const Contact& o) const {
        return std::tie(vertex, from, to) < std::tie(o.vertex, o.from, o.to);
    }
};

/// ½ stiffness Σ max(0, d + gap)² with d the distance of the vertex to the left of its edge: zero
/// once each vertex is `gap` outside. Lengths are in the plane.
struct ContactPenalty {
    std::vector<Contact> contacts;
    double stiffness = 0.0;
    double gap = 0.0;

    double energy(const Positions& x) const;
    void add_gradient(const Positions& x, Positions& gradient) const;
    /// Adds what is above its Hessian: a block for each vertex (#v). Contacts tie vertices that are
    /// no neighbours, for which the Hessian of a map has no place.
    void add_diagonal(const Positions& x, std::vector<Eigen::Matrix2d>& block) const;
};

} // namespace devseg::flatten
