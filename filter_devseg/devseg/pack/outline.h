// The outline of a flat chart, the only part of it that packing looks at, and its image on a grid:
// the cells that a chart, with half of the padding around it, touches.
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

/// Cells first … last − 1 of one row.
struct CellRun {
    Index row = 0;
    Index first = 0;
    Index last = 0;
};

struct WeightedRun {
    CellRun cells;
    Index weight = 1;
};

/// One chart in one orientation.
struct ChartCells {
    Index width = 0;     // cells
    Index height = 0;    // cells
    Index count = 0;     // set cells
    double cosine = 1.0; // the rotation
    double sine = 0.0;
    Vec2 offset = Vec2::Zero(); // the translation after it that puts the chart on the image
    std::vector<CellRun> runs;  // row by row, from left to right

    /// What it costs others to lie on this chart: nested runs whose weights add up to about the
    /// distance from the outline, so that a way out of an overlap is downhill.
    std::vector<WeightedRun> obstacle;
};

/// All cells that touch the chart, turned by `angle` and grown by `margin` on all sides (and a few
/// more: the image is conservative). The image is as small as possible; the obstacle is flat.
ChartCells rasterize(const Outline& outline, double angle, double cell, double margin);

/// The image on cells `factor` times as wide: the cells of which at least a share is covered. With
/// one half, faithful on average, not conservative.
ChartCells coarsen(const ChartCells& fine, Index factor, double share = 0.5);

} // namespace devseg::pack
