#include "devseg/pack/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "devseg/plane/plane.h"

namespace devseg::pack {

namespace {

// Andrew's monotone chain, counterclockwise.
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3)
        return points;
    std::vector<Vec2> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t start = hull.size();
        for (const Vec2& p : points) {
            while (hull.size() >= start + 2 &&
                   plane::cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

// Half of an edge's record, kept with its lower vertex.
struct Link {
    Index other;
    Index sign; // +1 runs from the lower to the other vertex, −1 the other way
};

} // namespace

Outline find_outline(const std::vector<Triangle>& faces, const std::vector<Vec2>& points) {
    Outline outline;
    std::vector<std::size_t> start(points.size() + 1, 0);
    for (const Triangle& t : faces)
        for (std::size_t k = 0; k < 3; ++k)
            ++start[at(std::min(t[k], t[(k + 1) % 3])) + 1];
    for (std::size_t v = 0; v < points.size(); ++v)
        start[v + 1] += start[v];
    std::vector<Link> links(3 * faces.size());
    std::vector<std::size_t> end(start.begin(), start.end() - 1);
    for (const Triangle& t : faces) {
        const double twice = plane::cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
        outline.area += 0.5 * std::abs(twice);
        const Index orientation = twice < 0.0 ? -1 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
            links[end[low]++] = {high, low == t[k] ? orientation : -orientation};
        }
    }
    std::vector<Vec2> corners;
    for (std::size_t v = 0; v < points.size(); ++v) {
        const auto first = links.begin() + static_cast<std::ptrdiff_t>(start[v]);
        const auto last = links.begin() + static_cast<std::ptrdiff_t>(start[v + 1]);
        std::sort(first, last, [](const Link& a, const Link& b) { return a.other < b.other; });
        for (auto link = first; link != last;) {
            const Index other = link->other;
            Index sum = 0;
            for (; link != last && link->other == other; ++link)
                sum += link->sign;
            for (; sum != 0; sum += sum > 0 ? -1 : 1) {
                const Vec2& a = points[v];
                const Vec2& b = points[other];
                outline.edges.push_back(sum > 0 ? OutlineEdge{a, b} : OutlineEdge{b, a});
                corners.push_back(a);
                corners.push_back(b);
            }
        }
    }
    // Without faces, or with triangles that cancel altogether: no extent, but still a place.
    if (corners.empty())
        corners.push_back(points.empty() ? Vec2(0.0, 0.0) : points.front());
    outline.hull = convex_hull(std::move(corners));
    return outline;
}

Outline outline_of(const std::vector<std::vector<Vec2>>& rings) {
    Outline outline;
    for (const std::vector<Vec2>& ring : rings) {
        outline.area += plane::signed_area(ring);
        for (std::size_t i = 0; i < ring.size(); ++i)
            outline.edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
    outline.hull = convex_hull(rings.front());
    return outline;
}

double best_box_angle(const Outline& outline) {
    const std::vector<Vec2>& hull = outline.hull;
    double best = 0.0;
    double best_area = std::numeric_limits<double>::max();
    // One side of the least box lies on an edge of the convex hull.
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
        const double length = edge.norm();
        if (!(length > 0.0))
            continue;
        const Vec2 along = edge / length;
        const Eigen::AlignedBox2d box = plane::box_of(
            hull, [&](const Vec2& p) { return Vec2(along.dot(p), plane::cross(along, p)); });
        const double area = box.sizes().prod();
        if (area < best_area) {
            best_area = area;
            best = -std::atan2(along.y(), along.x());
        }
    }
    return best;
}

} // namespace devseg::pack
