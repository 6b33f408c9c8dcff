#include "devseg/flatten/contacts.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <set>

#include "devseg/flatten/map_tools.h"

namespace devseg {

namespace {

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 ab = b - a;
    const double length2 = ab.squaredNorm();
    const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
    return (p - a - t * ab).norm();
}

bool inside(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
    return orientation(a, b, p) > 0.0 && orientation(b, c, p) > 0.0 && orientation(c, a, p) > 0.0;
}

// The boundary edge nearest to the vertex that is reached from `start` over faces: other parts of
// the chart may have nearer edges, but the vertex is not on those.
Index nearest_exit(const ChartSurface& surface, const std::vector<Vec2>& uv, Index vertex,
                   Index start) {
    const Vec2& p = uv[at(vertex)];
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::set<Index> seen{start};
    queue.emplace(0.0, start);
    Index best = -1;
    double best_distance = std::numeric_limits<double>::max();
    while (!queue.empty() && queue.top().first < best_distance) {
        const Index f = queue.top().second;
        queue.pop();
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            const double d =
                distance_to_segment(p, uv[at(surface.origin(h))], uv[at(surface.target(h))]);
            const Index twin = surface.twin[at(h)];
            if (twin >= 0) {
                if (seen.insert(twin / 3).second)
                    queue.emplace(d, twin / 3);
            } else if (d < best_distance && surface.origin(h) != vertex &&
                       surface.target(h) != vertex) {
                best_distance = d;
                best = h;
            }
        }
    }
    return best;
}

// The distance of a vertex to the left of the line of its edge, with its derivatives.
struct SignedDistance {
    double value = 0.0;
    Vec2 by_vertex, by_from, by_to;
};

SignedDistance signed_distance(const Contact& contact, const Eigen::MatrixX2d& x) {
    const Vec2 p = x.row(contact.vertex).transpose();
    const Vec2 a = x.row(contact.from).transpose();
    const Vec2 b = x.row(contact.to).transpose();
    const Vec2 direction = (b - a).normalized();
    const Vec2 left(-direction.y(), direction.x());
    const double length = (b - a).norm();
    const double along = (p - a).dot(direction) / length; // 0 at `from`, 1 at `to`
    SignedDistance d;
    d.value = (p - a).dot(left);
    // A motion of the edge's ends moves the foot of the vertex in proportion.
    d.by_vertex = left;
    d.by_from = -(1.0 - along) * left;
    d.by_to = -along * left;
    return d;
}

} // namespace

std::vector<Contact> find_contacts(const ChartSurface& surface, const std::vector<Vec2>& uv,
                                   const std::vector<std::pair<Index, Index>>& pairs) {
    std::vector<std::uint8_t> on_boundary(surface.vertex.size(), 0);
    for (const std::vector<Index>& loop : surface.loops)
        for (const Index h : loop)
            on_boundary[at(surface.origin(h))] = 1;
    std::set<std::pair<Index, Index>> tested; // (vertex, face that it lies on)
    std::set<Contact> contacts;
    const auto test = [&](Index f, Index g) {
        const Triangle& t = surface.corners[at(g)];
        for (const Index v : surface.corners[at(f)]) {
            if (on_boundary[at(v)] == 0 || v == t[0] || v == t[1] || v == t[2] ||
                !tested.emplace(v, g).second ||
                !inside(uv[at(v)], uv[at(t[0])], uv[at(t[1])], uv[at(t[2])]))
                continue;
            const Index exit = nearest_exit(surface, uv, v, g);
            if (exit >= 0)
                contacts.insert({v, surface.origin(exit), surface.target(exit)});
        }
    };
    for (const auto& [f, g] : pairs) {
        test(f, g);
        test(g, f);
    }
    return {contacts.begin(), contacts.end()};
}

double ContactPenalty::energy(const Eigen::MatrixX2d& x) const {
    double sum = 0.0;
    for (const Contact& contact : contacts) {
        const double depth = signed_distance(contact, x).value + gap;
        if (depth > 0.0)
            sum += depth * depth;
    }
    return 0.5 * stiffness * sum;
}

void ContactPenalty::add_gradient(const Eigen::MatrixX2d& x, Eigen::MatrixX2d& gradient) const {
    for (const Contact& contact : contacts) {
        const SignedDistance d = signed_distance(contact, x);
        const double force = stiffness * (d.value + gap);
        if (force <= 0.0)
            continue;
        gradient.row(contact.vertex) += force * d.by_vertex.transpose();
        gradient.row(contact.from) += force * d.by_from.transpose();
        gradient.row(contact.to) += force * d.by_to.transpose();
    }
}

} // namespace devseg
