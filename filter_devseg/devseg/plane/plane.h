// The plane: areas, distances, what lies inside of what.
#pragma once

#include "devseg/base/numbers.h"

namespace devseg::plane {

/// Twice the signed area of the triangle (0, p, q): positive where q lies to the left of p.
inline double cross(const Vec2& p, const Vec2& q) {
    return p.x() * q.y() - p.y() * q.x();
}

/// Signed area of face f in the plane, in squared units of `uv`.
inline double uv_area(const CornerUv& uv, Index f) {
    return 0.5 * cross(uv[3 * f + 1] - uv[3 * f], uv[3 * f + 2] - uv[3 * f]);
}

} // namespace devseg::plane
