#include "devseg/plane/plane.h"

namespace devseg::plane {

namespace {

// Whether c, known to lie on the line through a and b, is between them.
bool is_between(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (c - a).dot(c - b) <= 0.0;
}

bool boxes_apart(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    return std::max(a.y(), b.y()) < std::min(c.y(), d.y()) ||
           std::max(c.y(), d.y()) < std::min(a.y(), b.y()) ||
           std::max(a.x(), b.x()) < std::min(c.x(), d.x()) ||
           std::max(c.x(), d.x()) < std::min(a.x(), b.x());
}

bool opposite(double p, double q) {
    return (p > 0.0 && q < 0.0) || (p < 0.0 && q > 0.0);
}

} // namespace

// A fan of triangles from the first point: as exact for polygons that lie far from the origin.
double signed_area(const std::vector<Vec2>& ring) {
    double twice = 0.0;
    for (std::size_t i = 2; i < ring.size(); ++i)
        twice += cross(ring[i - 1] - ring.front(), ring[i] - ring.front());
    return 0.5 * twice;
}

double perimeter(const std::vector<Vec2>& ring) {
    double length = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i)
        length += (ring[(i + 1) % ring.size()] - ring[i]).norm();
    return length;
}

bool segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    return !boxes_apart(a, b, c, d) && opposite(orientation(a, b, c), orientation(a, b, d)) &&
           opposite(orientation(c, d, a), orientation(c, d, b));
}

bool segments_touch(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    if (boxes_apart(a, b, c, d))
        return false;
    const double c_side = orientation(a, b, c);
    const double d_side = orientation(a, b, d);
    const double a_side = orientation(c, d, a);
    const double b_side = orientation(c, d, b);
    return (opposite(c_side, d_side) && opposite(a_side, b_side)) ||
           (c_side == 0.0 && is_between(a, b, c)) || (d_side == 0.0 && is_between(a, b, d)) ||
           (a_side == 0.0 && is_between(c, d, a)) || (b_side == 0.0 && is_between(c, d, b));
}

bool is_inside(const std::vector<Vec2>& ring, const Vec2& p) {
    bool inside = false;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
        if (meets_height(ring[j], ring[i], p.y()) && p.x() < x_at_height(ring[j], ring[i], p.y()))
            inside = !inside;
    return inside;
}

bool is_inside(const std::vector<std::vector<Vec2>>& rings, const Vec2& p) {
    bool inside = false;
    for (const std::vector<Vec2>& ring : rings)
        inside = inside != is_inside(ring, p);
    return inside;
}

} // namespace devseg::plane
