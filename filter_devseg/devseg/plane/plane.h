// The plane: areas, distances, angles, what lies inside of what.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "devseg/base/numbers.h"

namespace devseg::plane {

/// Twice the signed area of the triangle (0, p, q): positive where q lies to the left of p.
inline double cross(const Vec2& p, const Vec2& q) {
    return p.x() * q.y() - p.y() * q.x();
}

/// Twice the signed area of the triangle (a, b, c). The sign is exact: when rounding could have
/// changed it, the determinant is evaluated again without rounding.
double orientation(const Vec2& a, const Vec2& b, const Vec2& c);

/// Signed area of face f in the plane, in squared units of `uv`.
inline double uv_area(const CornerUv& uv, Index f) {
    return 0.5 * cross(uv[3 * f + 1] - uv[3 * f], uv[3 * f + 2] - uv[3 * f]);
}

/// Area of a triangle, never negative.
inline double triangle_area(const Vec2& a, const Vec2& b, const Vec2& c) {
    return 0.5 * std::abs(cross(b - a, c - a));
}

/// Of a closed polygon: its area, positive if it runs counterclockwise, and the length around it.
double signed_area(const std::vector<Vec2>& ring);
double perimeter(const std::vector<Vec2>& ring);

/// v turned by a quarter to the left.
inline Vec2 left_of(const Vec2& v) {
    return {-v.y(), v.x()};
}

/// p turned about the origin by the angle of this cosine and sine.
inline Vec2 turned(const Vec2& p, double cosine, double sine) {
    return {cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y()};
}

/// The angle from p to q, −π to π, positive to the left.
inline double signed_angle(const Vec2& p, const Vec2& q) {
    return std::atan2(cross(p, q), p.dot(q));
}

/// The angle between p and q, 0 to π.
inline double angle_between(const Vec2& p, const Vec2& q) {
    return std::abs(signed_angle(p, q));
}

/// By how much the way from a over b to c turns at b, 0 to π.
inline double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    return angle_between(b - a, c - b);
}

/// Where the point of the segment a b nearest to p lies: 0 at a, 1 at b.
inline double nearest_share(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 along = b - a;
    const double length = along.squaredNorm();
    return length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
}

inline Vec2 nearest_point(const Vec2& p, const Vec2& a, const Vec2& b) {
    return a + nearest_share(p, a, b) * (b - a);
}

inline double squared_distance(const Vec2& p, const Vec2& a, const Vec2& b) {
    return (p - a - nearest_share(p, a, b) * (b - a)).squaredNorm();
}

/// Distance of p from the segment a b.
inline double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
    return std::sqrt(squared_distance(p, a, b));
}

/// Whether the insides of the segments a b and c d cross in one point; exact.
bool segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// Whether the segments have a common point, ends included; exact.
bool segments_touch(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// Whether the line from a to b meets the horizontal line at height y, and where. Half-open, so
/// that a line through a corner of a polygon meets one of its two edges.
inline bool meets_height(const Vec2& a, const Vec2& b, double y) {
    return (a.y() > y) != (b.y() > y);
}
inline double x_at_height(const Vec2& a, const Vec2& b, double y) {
    return a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

/// Whether p lies inside of closed polygons, by the even-odd rule.
bool is_inside(const std::vector<Vec2>& ring, const Vec2& p);
bool is_inside(const std::vector<std::vector<Vec2>>& rings, const Vec2& p);

/// The bounding box of the points, moved by `map`; empty without points.
template <class Map>
Eigen::AlignedBox2d box_of(const std::vector<Vec2>& points, Map map) {
    Eigen::AlignedBox2d box;
    for (const Vec2& p : points)
        box.extend(Vec2(map(p)));
    return box;
}
inline Eigen::AlignedBox2d box_of(const std::vector<Vec2>& points) {
    return box_of(points, [](const Vec2& p) { return p; });
}

} // namespace devseg::plane
