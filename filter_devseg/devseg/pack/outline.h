// The outline of a flat chart: the only part of it that packing looks at.
//
// Every triangle is taken as positively oriented and edges that run in opposite directions cancel.
// What remains winds around a point as often as triangles cover it, so that "winding number not
// zero" is the exact union of the triangles - with slits, holes, folds and flipped triangles.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::pack {

struct OutlineEdge {
    Vec2 from;
    Vec2 to;
};

struct Outline {
    std::vector<OutlineEdge> edges; // in the chart's coordinates
    std::vector<Vec2> hull;         // convex hull, counterclockwise; at least one point
    double area = 0.0;              // sum of the triangles' areas
};

Outline find_outline(const std::vector<Triangle>& faces, const std::vector<Vec2>& points);

/// Of closed rings, the outer one first.
Outline outline_of(const std::vector<std::vector<Vec2>>& rings);

/// Angle in radians to turn the chart by, after which its bounding box has the least area.
double best_box_angle(const Outline& outline);

} // namespace devseg::pack
