#include "devseg/flatten/repair/overlaps.h"

#include <algorithm>
#include <queue>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/graph/min_cut.h"
#include "devseg/plane/overlap.h"

namespace devseg::flatten {

namespace {

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

int sign(double x) {
    return x > 0.0 ? 1 : x < 0.0 ? -1 : 0;
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
    const int s1 = sign(orientation(s.a, s.b, t.a));
    const int s2 = sign(orientation(s.a, s.b, t.b));
    const int t1 = sign(orientation(t.a, t.b, s.a));
    const int t2 = sign(orientation(t.a, t.b, s.b));
    if (s1 == 0 && s2 == 0) { // on one line: do the boxes overlap?
        const Vec2 low = s.a.cwiseMin(s.b).cwiseMax(t.a.cwiseMin(t.b));
        const Vec2 high = s.a.cwiseMax(s.b).cwiseMin(t.a.cwiseMax(t.b));
        return (high - low).minCoeff() >= 0.0;
    }
    return s1 * s2 <= 0 && t1 * t2 <= 0;
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

// Faces that take part in an overlap, split between the two faces of the first pair: each goes to
// the one from which it is reached first through such faces.
std::vector<graph::CutSide> two_sides(const atlas::ChartSurface& surface,
                                      const std::vector<std::pair<Index, Index>>& pairs) {
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
            if (twin >= 0 && takes_part[twin / 3] != 0 && side[twin / 3] == graph::CutSide::open) {
                side[twin / 3] = side[f];
                queue.push(twin / 3);
            }
        }
    }
    return side;
}

} // namespace

bool boundary_crosses_itself(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv) {
    return any_crossing(boundary_segments(surface, uv));
}

std::vector<std::pair<Index, Index>> overlapping_pairs(const atlas::ChartSurface& surface,
                                                       const std::vector<Vec2>& uv,
                                                       double tolerance) {
    if (!boundary_crosses_itself(surface, uv))
        return {};
    CornerUv corners;
    corners.reserve(3 * surface.faces.size());
    for (const Triangle& t : surface.faces)
        for (const Vertex v : t)
            corners.push_back(uv[v]);
    return plane::find_overlapping_pairs(corners, tolerance);
}

std::vector<Index> separating_path(const Mesh& mesh, const atlas::ChartSurface& surface,
                                   const std::vector<std::pair<Index, Index>>& pairs,
                                   const Progress& progress) {
    // In a disk, the least border between two connected sets of faces is one path from boundary to
    // boundary: the cut makes two disks.
    graph::MinCut cut(two_sides(surface, pairs));
    for (const HalfEdge h : surface.all_half_edges())
        if (surface.twin[h] > h)
            cut.link(h / 3, surface.twin[h] / 3, mesh.edge_length(surface.mesh_half_edge(h)));
    const std::vector<graph::CutSide> side = cut.solve(progress);
    std::vector<Index> path;
    for (const HalfEdge h : surface.all_half_edges())
        if (surface.twin[h] >= 0 && side[h / 3] == graph::CutSide::source &&
            side[surface.twin[h] / 3] == graph::CutSide::sink)
            path.push_back(h);
    return path;
}

} // namespace devseg::flatten
