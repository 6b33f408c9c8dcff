// References
//   V. Agafonkin: A new algorithm for finding a visual center of a polygon. 2016 (polylabel):
//   quadtree refinement of the cells with the highest bound first.
#include "devseg/pattern/label_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// A name may be off the best place by this share of its room: nobody sees it.
constexpr double precision = 0.02;

// Bounds the time on outlines with thousands of points; a compact piece needs about 50 cells.
constexpr int cell_limit = 1000;

using Outlines = std::vector<const std::vector<Vec2>*>;

// Calls visit(a, b) for every segment.
template <class Visit>
void for_each_segment(const Outlines& outlines, Visit visit) {
    for (const std::vector<Vec2>* points : outlines)
        for (std::size_t i = 0, j = points->size() - 1; i < points->size(); j = i++)
            visit((*points)[j], (*points)[i]);
}

// Distance from the outlines, negative outside.
double signed_distance(const Outlines& outlines, const Vec2& p) {
    double nearest = infinite;
    bool inside = false;
    for_each_segment(outlines, [&](const Vec2& a, const Vec2& b) {
        if (plane::meets_height(a, b, p.y()) && p.x() < plane::x_at_height(a, b, p.y()))
            inside = !inside;
        nearest = std::min(nearest, plane::squared_distance(p, a, b));
    });
    return inside ? std::sqrt(nearest) : -std::sqrt(nearest);
}

// The middle of the widest stretch inside on the line at height y: in every piece, however thin.
LabelPoint widest_on_line(const Outlines& outlines, double y) {
    std::vector<double> xs;
    for_each_segment(outlines, [&](const Vec2& a, const Vec2& b) {
        if (plane::meets_height(a, b, y))
            xs.push_back(plane::x_at_height(a, b, y));
    });
    std::sort(xs.begin(), xs.end());
    LabelPoint best;
    double width = -1.0;
    for (std::size_t i = 0; i + 1 < xs.size(); i += 2)
        if (xs[i + 1] - xs[i] > width) {
            width = xs[i + 1] - xs[i];
            best.position = Vec2(0.5 * (xs[i] + xs[i + 1]), y);
        }
    best.radius = signed_distance(outlines, best.position);
    return best;
}

struct Cell {
    Vec2 centre;
    double half;     // of the side
    double distance; // signed, of the centre
    double bound;    // no point of the cell is farther from the outlines

    bool operator<(const Cell& other) const { return bound < other.bound; }
};

Cell make_cell(const Outlines& outlines, const Vec2& centre, double half) {
    const double distance = signed_distance(outlines, centre);
    return {centre, half, distance, distance + half * std::sqrt(2.0)};
}

} // namespace

LabelPoint find_label_point(const Outlines& outlines) {
    const Eigen::AlignedBox2d box = plane::box_of(*outlines.front());
    const Vec2 low = box.min();
    const Vec2 size = box.sizes();
    LabelPoint best = widest_on_line(outlines, low.y() + 0.5 * size.y());
    if (!(size.minCoeff() > 0.0))
        return {best.position, 0.0};

    // Square cells, at most 16 on the longer side: slivers are left to the refinement.
    const double side = std::max(size.minCoeff(), size.maxCoeff() / 16.0);
    const int columns = static_cast<int>(std::ceil(size.x() / side));
    const int rows = static_cast<int>(std::ceil(size.y() / side));
    std::priority_queue<Cell> cells;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j)
            cells.push(make_cell(outlines, low + side * Vec2(i + 0.5, j + 0.5), 0.5 * side));

    for (int made = 0; made < cell_limit && !cells.empty();) {
        const Cell cell = cells.top();
        cells.pop();
        if (cell.distance > best.radius)
            best = {cell.centre, cell.distance};
        if (cell.bound <= (1.0 + precision) * best.radius)
            break;
        const double half = 0.5 * cell.half;
        for (const double dx : {-half, half})
            for (const double dy : {-half, half})
                cells.push(make_cell(outlines, cell.centre + Vec2(dx, dy), half));
        made += 4;
    }
    best.radius = std::max(best.radius, 0.0);
    return best;
}

} // namespace devseg::pattern
