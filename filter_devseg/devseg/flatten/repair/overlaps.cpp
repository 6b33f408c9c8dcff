#include "devseg/flatten/repair/overlaps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <queue>
#include <set>

#include "devseg/atlas/border_path.h"
#include "devseg/flatten/energy/laplacian.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/graph/min_cut.h"
#include "devseg/plane/overlap.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    int push_rounds = 10;           // each twice as stiff as the one before
    int idle_rounds = 2;            // rounds that may not lower the number of overlaps
    double first_stiffness = 100.0; // in units of the energy per chart area
    // Shape that pushing apart may cost, as growth of the symmetric Dirichlet energy: beyond it, a
    // cut keeps the pattern truer than a deformation.
    double push_cost = 0.01;
};
constexpr Tuning tuning;

struct Segment {
    Vec2 a, b;
    Index from, to; // vertices
};

std::vector<Segment> boundary_segments(const atlas::ChartSurface& surface,
                                       const std::vector<Vec2>& uv) {
    std::vector<Segment> segments;
    for (const std::vector<Index>& loop : surface.loops)
        for (const HalfEdge h : loop)
            segments.push_back({uv[surface.origin(h)], uv[surface.target(h)], surface.origin(h),
                                surface.target(h)});
    return segments;
}

// Segments that cross in a point inside both, or that touch with an end: anything but apart.
bool cross(const Segment& s, const Segment& t) {
    if (s.from == t.from || s.from == t.to || s.to == t.from || s.to == t.to) {
        // Neighbours share a point anyway. They overlap only when one folds back onto the other.
        const Vec2& common = s.to == t.from || s.to == t.to ? s.b : s.a;
        const Vec2& p = &common == &s.b ? s.a : s.b;
        const Vec2& q = t.from == s.to || t.from == s.from ? t.b : t.a;
        return orientation(common, p, q) == 0.0 && (p - common).dot(q - common) > 0.0;
    }
    return plane::segments_touch(s.a, s.b, t.a, t.b);
}

// Sweep over x with the segments that are active; boundaries are short compared with their charts.
bool any_crossing(std::vector<Segment> segments) {
    const auto low_x = [](const Segment& s) { return std::min(s.a.x(), s.b.x()); };
    const auto high_x = [](const Segment& s) { return std::max(s.a.x(), s.b.x()); };
    const auto low_y = [](const Segment& s) { return std::min(s.a.y(), s.b.y()); };
    const auto high_y = [](const Segment& s) { return std::max(s.a.y(), s.b.y()); };
    std::sort(segments.begin(), segments.end(),
              [&](const Segment& s, const Segment& t) { return low_x(s) < low_x(t); });
    std::vector<const Segment*> active;
    for (const Segment& s : segments) {
        active.erase(std::remove_if(active.begin(), active.end(),
                                    [&](const Segment* t) { return high_x(*t) < low_x(s); }),
                     active.end());
        for (const Segment* t : active)
            if (low_y(*t) <= high_y(s) && low_y(s) <= high_y(*t) && cross(s, *t))
                return true;
        active.push_back(&s);
    }
    return false;
}

// Loops that run around what lies on their left: the rim, and holes that are turned inside out.
Index outer_loops(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv) {
    Index count = 0;
    for (const std::vector<Index>& loop : surface.loops) {
        const Vec2& base = uv[surface.origin(loop.front())];
        double twice_area = 0.0;
        for (const HalfEdge h : loop)
            twice_area += plane::cross(uv[surface.origin(h)] - base, uv[surface.target(h)] - base);
        count += twice_area > 0.0 ? 1 : 0;
    }
    return count;
}

// Faces that take part in an overlap, split between the two faces of the first pair: each goes to
// the one from which it is reached first through such faces.
std::vector<graph::CutSide> two_sides(const atlas::ChartSurface& surface, const Pairs& pairs) {
    std::vector<graph::CutSide> side(surface.face.size(), graph::CutSide::open);
    std::vector<std::uint8_t> takes_part(surface.face.size(), 0);
    for (const auto& [f, g] : pairs)
        takes_part[f] = takes_part[g] = 1;
    std::queue<Index> queue;
    side[pairs.front().first] = graph::CutSide::source;
    side[pairs.front().second] = graph::CutSide::sink;
    queue.push(pairs.front().first);
    queue.push(pairs.front().second);
    while (!queue.empty()) {
        const Face f = queue.front();
        queue.pop();
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = surface.twin[h];
            if (twin < 0)
                continue;
            const Face g = face_of(twin);
            if (takes_part[g] != 0 && side[g] == graph::CutSide::open) {
                side[g] = side[f];
                queue.push(g);
            }
        }
    }
    return side;
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
            const double d = plane::distance(p, uv[surface.origin(h)], uv[surface.target(h)]);
            const HalfEdge twin = surface.twin[h];
            if (twin >= 0) {
                if (seen.insert(face_of(twin)).second)
                    queue.emplace(d, face_of(twin));
            } else if (d < best_distance && surface.origin(h) != vertex &&
                       surface.target(h) != vertex) {
                best_distance = d;
                best = h;
            }
        }
    }
    return best;
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
    void find_full_turn(Face f, Face g) {
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
    void find_inside(Face f, Face g) {
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
                plane::nearest_share(uv_[v], uv_[s_.origin(exit)], uv_[s_.target(exit)]);
            if (along <= 0.0)
                add(v, previous_on_boundary(s_, exit));
            if (along >= 1.0)
                add(v, next_on_boundary(s_, exit));
        }
    }

    // Boundary edges of f and g that cross although no end lies on the other face: the end that is
    // least far inside leaves.
    void find_crossings(Face f, Face g) {
        for (const HalfEdge h : half_edges_of(f))
            for (const HalfEdge k : half_edges_of(g))
                if (s_.twin[h] < 0 && s_.twin[k] < 0 && !has_contact(h) && !has_contact(k) &&
                    cross(segment(h), segment(k)))
                    add_least_deep(h, k);
    }

    std::vector<Contact> contacts() const { return {contacts_.begin(), contacts_.end()}; }

private:
    void add(Vertex v, HalfEdge h) {
        if (s_.origin(h) != v && s_.target(h) != v)
            contacts_.insert({v, s_.origin(h), s_.target(h)});
    }

    Segment segment(HalfEdge h) const {
        return {uv_[s_.origin(h)], uv_[s_.target(h)], s_.origin(h), s_.target(h)};
    }

    bool has_contact(HalfEdge h) const {
        return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& contact) {
            return contact.vertex == s_.origin(h) || contact.vertex == s_.target(h);
        });
    }

    void add_least_deep(HalfEdge h, HalfEdge k) {
        Vertex best;
        HalfEdge out;
        double least = infinite;
        for (const auto& [edge, other] : {std::pair(h, k), std::pair(k, h)})
            for (const Vertex v : {s_.origin(other), s_.target(other)}) {
                const Vec2 along = uv_[s_.target(edge)] - uv_[s_.origin(edge)];
                const double depth =
                    plane::left_of(along).dot(uv_[v] - uv_[s_.origin(edge)]) / along.norm();
                if (depth >= 0.0 && depth < least) {
                    least = depth;
                    best = v;
                    out = edge;
                }
            }
        if (least < infinite)
            add(best, out);
    }

    const atlas::ChartSurface& s_;
    const std::vector<Vec2>& uv_;
    std::vector<Index> leaving_;        // #v: boundary half-edge from the vertex, −1 = inside
    std::vector<std::uint8_t> settled_; // #v: 1 where a full turn says which way to go
    std::set<std::pair<Index, Index>> tested_;
    std::set<Contact> contacts_;
};

std::vector<Contact> find_contacts(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                                   const Pairs& pairs) {
    ContactFinder finder(surface, uv);
    for (const auto& [f, g] : pairs)
        finder.find_full_turn(f, g);
    for (const auto& [f, g] : pairs) {
        finder.find_inside(f, g);
        finder.find_inside(g, f);
    }
    for (const auto& [f, g] : pairs)
        finder.find_crossings(f, g);
    return finder.contacts();
}

// Contacts of earlier rounds stay, because parts that were pushed apart must not come back, except
// where a vertex has new ones.
std::vector<Contact> merge_contacts(const std::vector<Contact>& old,
                                    std::vector<Contact> contacts) {
    const std::size_t found = contacts.size();
    for (const Contact& contact : old)
        if (std::none_of(contacts.begin(), contacts.begin() + static_cast<std::ptrdiff_t>(found),
                         [&](const Contact& c) { return c.vertex == contact.vertex; }))
            contacts.push_back(contact);
    return contacts;
}

CornerUv corners_of(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv) {
    CornerUv corners;
    corners.reserve(3 * surface.faces.size());
    for (const Triangle& t : surface.faces)
        for (const Vertex v : t)
            corners.push_back(uv[v]);
    return corners;
}

} // namespace

bool is_one_to_one(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv) {
    return outer_loops(surface, uv) <= 1 && !any_crossing(boundary_segments(surface, uv));
}

Pairs overlapping_pairs(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                        double tolerance) {
    if (is_one_to_one(surface, uv))
        return {};
    return plane::find_overlapping_pairs(corners_of(surface, uv), tolerance);
}

bool overlaps_itself(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                     double tolerance) {
    return !is_one_to_one(surface, uv) && plane::any_overlap(corners_of(surface, uv), tolerance);
}

std::vector<Index> separating_path(const Mesh& mesh, const atlas::ChartSurface& surface,
                                   const Pairs& pairs, const Progress& progress, bool at_folds) {
    // In a disk, the least border between two connected sets of faces is one path from boundary to
    // boundary: the cut makes two disks. Around holes it may be several.
    graph::MinCut cut(two_sides(surface, pairs));
    for (const HalfEdge h : surface.all_half_edges())
        if (surface.twin[h] > h) {
            const HalfEdge edge = surface.mesh_half_edge(h);
            cut.link(face_of(h), face_of(surface.twin[h]),
                     atlas::cut_cost(mesh, edge) *
                         (at_folds ? atlas::crease_factor(mesh, edge) : 1.0));
        }
    const std::vector<graph::CutSide> side = cut.solve(progress);
    std::vector<Index> path;
    for (const HalfEdge h : surface.all_half_edges())
        if (surface.twin[h] >= 0 && side[face_of(h)] == graph::CutSide::source &&
            side[face_of(surface.twin[h])] == graph::CutSide::sink)
            path.push_back(h);
    return path;
}

std::optional<std::vector<Vec2>> push_apart_by(const PushContacts& push,
                                               const FlatteningProblem& problem,
                                               const atlas::ChartSurface& surface,
                                               std::vector<Vec2> uv, Pairs pairs, double tolerance,
                                               double gap_share) {
    const double before = symmetric_dirichlet_energy(problem, uv);
    ContactPenalty penalty;
    penalty.stiffness = tuning.first_stiffness / problem.total_area;
    penalty.gap = gap_share * std::sqrt(problem.total_area);
    std::size_t fewest = pairs.size();
    int idle = 0;
    for (int round = 0; round < tuning.push_rounds && idle < tuning.idle_rounds; ++round) {
        const ContactPenalty found{find_contacts(surface, uv, pairs), penalty.stiffness, 0.0};
        if (found.energy(positions_of(uv)) == 0.0) // nothing to push: more than a turn too much
            return std::nullopt;
        penalty.contacts = merge_contacts(penalty.contacts, found.contacts);
        uv = push(uv, penalty);
        if (uv.empty() || symmetric_dirichlet_energy(problem, uv) > before + tuning.push_cost)
            return std::nullopt;
        pairs = overlapping_pairs(surface, uv, tolerance);
        if (pairs.empty())
            return uv;
        idle = pairs.size() < fewest ? 0 : idle + 1;
        fewest = std::min(fewest, pairs.size());
        penalty.stiffness *= 2.0;
    }
    return std::nullopt;
}

std::optional<std::vector<Vec2>> push_apart(const FlatteningProblem& problem,
                                            const atlas::ChartSurface& surface,
                                            std::vector<Vec2> uv, Pairs pairs, double tolerance,
                                            const Progress& progress, double gap_share) {
    const auto laplacian = attempt([&] { return std::make_unique<Laplacian>(problem); });
    if (!laplacian) // needles: a cut is left
        return std::nullopt;
    SymmetricDirichletOptions options;
    options.max_iterations = 30;
    options.laplacian = laplacian.get();
    const auto push = [&](const std::vector<Vec2>& start, const ContactPenalty& contacts) {
        std::vector<Vec2> moved = attempt([&] {
            return minimise_symmetric_dirichlet(problem, start, options, progress, contacts).uv;
        });
        if (!moved.empty())
            scale_to_area(problem, moved);
        return moved;
    };
    return push_apart_by(push, problem, surface, std::move(uv), std::move(pairs), tolerance,
                         gap_share);
}

} // namespace devseg::flatten
