#include "devseg/flatten/energy/contacts.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <set>

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

// Where the point of the segment nearest to p lies: 0 at a, 1 at b.
double nearest_parameter(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 ab = b - a;
    const double length2 = ab.squaredNorm();
    return length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    return (p - a - nearest_parameter(p, a, b) * (b - a)).norm();
}

Index next_on_boundary(const atlas::ChartSurface& surface, HalfEdge h) {
    h = Mesh::next(h);
    while (surface.twin[h] >= 0)
        h = Mesh::next(surface.twin[h]);
    return h;
}

Index previous_on_boundary(const atlas::ChartSurface& surface, HalfEdge h) {
    h = Mesh::previous(h);
    while (surface.twin[h] >= 0)
        h = Mesh::previous(surface.twin[h]);
    return h;
}

bool inside(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
    return orientation(a, b, p) > 0.0 && orientation(b, c, p) > 0.0 && orientation(c, a, p) > 0.0;
}

// The boundary edge nearest to the vertex that is reached from `start` over faces: other parts of
// the chart may have nearer edges, but the vertex is not on those.
Index nearest_exit(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv, Vertex vertex,
                   Index start) {
    const Vec2& p = uv[vertex];
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::set<Index> seen{start};
    queue.emplace(0.0, start);
    Index best = -1;
    double best_distance = std::numeric_limits<double>::max();
    while (!queue.empty() && queue.top().first < best_distance) {
        const Face f = queue.top().second;
        queue.pop();
        for (const HalfEdge h : half_edges_of(f)) {
            const double d = distance_to_segment(p, uv[surface.origin(h)], uv[surface.target(h)]);
            const HalfEdge twin = surface.twin[h];
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

// Finds the contacts of overlapping pairs of faces.
class ContactFinder {
public:
    ContactFinder(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv)
        : s_(surface), uv_(uv), leaving_(surface.vertex.size(), -1),
          settled_(surface.vertex.size(), 0) {
        for (const std::vector<Index>& loop : surface.loops)
            for (const HalfEdge h : loop)
                leaving_[surface.origin(h)] = h;
    }

    // Faces that overlap around a common boundary vertex: the surface turns by more than 360
    // degrees there. Each neighbour on the boundary must get outside of the other one's edge.
    void find_full_turn(Face f, Index g) {
        for (const Vertex v : s_.faces[f]) {
            const Triangle& t = s_.faces[g];
            if (leaving_[v] < 0 || (v != t[0] && v != t[1] && v != t[2]))
                continue;
            const Index out = leaving_[v];
            const Index in = previous_on_boundary(s_, out);
            settled_[s_.origin(in)] = settled_[s_.target(out)] = 1;
            add(s_.origin(in), out);
            add(s_.target(out), in);
        }
    }

    // Boundary vertices of f that lie on g leave across the nearest boundary edge.
    void find_inside(Face f, Index g) {
        const Triangle& t = s_.faces[g];
        for (const Vertex v : s_.faces[f]) {
            if (leaving_[v] < 0 || settled_[v] != 0 || v == t[0] || v == t[1] || v == t[2] ||
                !tested_.emplace(v, g).second || !inside(uv_[v], uv_[t[0]], uv_[t[1]], uv_[t[2]]))
                continue;
            const Index exit = nearest_exit(s_, uv_, v, g);
            if (exit < 0)
                continue;
            add(v, exit);
            // Past a corner that points inwards, the vertex must get outside of both its edges.
            const double along =
                nearest_parameter(uv_[v], uv_[s_.origin(exit)], uv_[s_.target(exit)]);
            if (along <= 0.0)
                add(v, previous_on_boundary(s_, exit));
            if (along >= 1.0)
                add(v, next_on_boundary(s_, exit));
        }
    }

    std::vector<Contact> contacts() const { return {contacts_.begin(), contacts_.end()}; }

private:
    void add(Vertex v, HalfEdge h) {
        if (s_.origin(h) != v && s_.target(h) != v)
            contacts_.insert({v, s_.origin(h), s_.target(h)});
    }

    const atlas::ChartSurface& s_;
    const std::vector<Vec2>& uv_;
    std::vector<Index> leaving_;        // #v: boundary half-edge from the vertex, −1 = inside
    std::vector<std::uint8_t> settled_; // #v: 1 where a full turn says which way to go
    std::set<std::pair<Index, Index>> tested_;
    std::set<Contact> contacts_;
};

} // namespace

std::vector<Contact> find_contacts(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                                   const std::vector<std::pair<Index, Index>>& pairs) {
    ContactFinder finder(surface, uv);
    for (const auto& [f, g] : pairs)
        finder.find_full_turn(f, g);
    for (const auto& [f, g] : pairs) {
        finder.find_inside(f, g);
        finder.find_inside(g, f);
    }
    return finder.contacts();
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

} // namespace devseg::flatten
