// References
//   V. Agafonkin: A new algorithm for finding a visual center of a polygon. 2016 (polylabel):
//   quadtree refinement of the cells with the highest bound first.
#include "devseg/pattern/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "devseg/pack/outline.h"
#include "devseg/pattern/outlines.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// The grain line leaves this share of its length free at each end.
constexpr double grain_margin = 0.12;

// The stretch of the line through `p` around p that lies inside the piece.
std::array<Vec2, 2> chord_through(const PatternPiece& piece, const Vec2& p, const Vec2& along) {
    double back = -infinite;
    double ahead = infinite;
    const auto side = [&](const Vec2& q) { return plane::cross(along, q - p); };
    for (Index l = 0; l < piece.path_count(); ++l) {
        const std::vector<Vec2>& points = piece.path(l).points;
        for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++) {
            const double a = side(points[j]);
            const double b = side(points[i]);
            if ((a > 0.0) == (b > 0.0))
                continue;
            const double t = (points[j] + a / (a - b) * (points[i] - points[j]) - p).dot(along);
            (t < 0.0 ? back : ahead) = t < 0.0 ? std::max(back, t) : std::min(ahead, t);
        }
    }
    if (!std::isfinite(back) || !std::isfinite(ahead))
        return {p, p};
    const double margin = grain_margin * (ahead - back);
    return {p + (back + margin) * along, p + (ahead - margin) * along};
}

// A name may be off the best place by this share of its room: nobody sees it.
constexpr double label_precision = 0.02;

// Bounds the time on outlines with thousands of points; a compact piece needs about 50 cells.
constexpr int cell_limit = 1000;

using Outlines = std::vector<std::vector<Vec2>>;

// Calls visit(a, b) for every segment.
template <class Visit>
void for_each_segment(const Outlines& outlines, Visit visit) {
    for (const std::vector<Vec2>& points : outlines)
        for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++)
            visit(points[j], points[i]);
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

PieceBox least_box(const std::vector<Vec2>& points) {
    const double angle = pack::best_box_angle(pack::outline_of({points}));
    const Vec2 along(std::cos(angle), -std::sin(angle));
    const Vec2 across = plane::left_of(along);
    const Vec2 size = plane::box_of(points, [&](const Vec2& p) {
                          return Vec2(along.dot(p), across.dot(p));
                      }).sizes();
    PieceBox result{size.maxCoeff(), size.minCoeff(), size.x() >= size.y() ? along : across};
    if (result.direction.y() < 0.0 || (result.direction.y() == 0.0 && result.direction.x() < 0.0))
        result.direction = -result.direction;
    return result;
}

PieceBox set_sizes(PatternPiece& piece) {
    const PieceBox box = least_box(piece.outer.points);
    piece.long_side = box.long_side;
    piece.short_side = box.short_side;
    return box;
}

void set_grain(PatternPiece& piece, const Vec2& direction) {
    piece.grain = chord_through(piece, piece.label_position, direction);
}

LabelPoint find_label_point(const Outlines& outlines) {
    const Eigen::AlignedBox2d box = plane::box_of(outlines.front());
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
        if (cell.bound <= (1.0 + label_precision) * best.radius)
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
