// References
//   V. Agafonkin: A new algorithm for finding a visual center of a polygon. 2016 (polylabel):
//   quadtree refinement of the cells with the highest bound first.
#include "devseg/pattern/shapes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <queue>

#include "devseg/pack/outline.h"
#include "devseg/pattern/outlines.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

using Complex = std::complex<double>;

// Places along an outline that are compared at first; afterwards each is brought to the nearest
// point of the other outline.
constexpr std::size_t places = 96;
constexpr int motion_rounds = 12;

// Two pieces of one shape differ by less than this share of their size, whatever the tolerance.
constexpr double size_share = 0.01;

// Outlines of one shape differ in length by less than this share, however ragged they are.
constexpr double length_raggedness = 0.1;

// The grain line leaves this share of its length free at each end.
constexpr double grain_margin = 0.12;

Complex number(const Vec2& p) {
    return {p.x(), p.y()};
}

Vec2 point(const Complex& z) {
    return {z.real(), z.imag()};
}

std::vector<Vec2> even_points(const std::vector<Vec2>& outline, std::size_t count) {
    const double step = plane::perimeter(outline) / static_cast<double>(count);
    std::vector<Vec2> result;
    double arc = 0.0;
    for (std::size_t i = 0; i < outline.size() && result.size() < count; ++i) {
        const Vec2 along = outline[(i + 1) % outline.size()] - outline[i];
        const double length = along.norm();
        while (result.size() < count && static_cast<double>(result.size()) * step < arc + length)
            result.push_back(outline[i] +
                             (static_cast<double>(result.size()) * step - arc) / length * along);
        arc += length;
    }
    result.resize(count, outline.front());
    return result;
}

Vec2 nearest_on(const std::vector<Vec2>& outline, const Vec2& p) {
    Vec2 best = outline.front();
    double least = infinite;
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
        const Vec2 q = plane::nearest_point(p, outline[j], outline[i]);
        if ((p - q).squaredNorm() < least) {
            least = (p - q).squaredNorm();
            best = q;
        }
    }
    return best;
}

// p → turn · p + shift, in complex numbers.
struct Motion {
    Complex turn{1.0, 0.0};
    Complex shift{0.0, 0.0};

    Vec2 operator()(const Vec2& p) const { return point(turn * number(p) + shift); }
};

// The rigid motion that brings from[i] nearest to to[(i + offset) mod n], in the mean square.
// `error`: what is left.
Motion fit_motion(const std::vector<Vec2>& from, const std::vector<Vec2>& to, std::size_t offset,
                  double& error) {
    const std::size_t n = from.size();
    Complex mean_from{0.0, 0.0};
    Complex mean_to{0.0, 0.0};
    for (std::size_t i = 0; i < n; ++i) {
        mean_from += number(from[i]) / static_cast<double>(n);
        mean_to += number(to[i]) / static_cast<double>(n);
    }
    Complex product{0.0, 0.0};
    double spread = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const Complex a = number(from[i]) - mean_from;
        const Complex b = number(to[(i + offset) % n]) - mean_to;
        product += std::conj(a) * b;
        spread += std::norm(a) + std::norm(b);
    }
    Motion motion;
    if (std::abs(product) > 0.0)
        motion.turn = product / std::abs(product);
    motion.shift = mean_to - motion.turn * mean_from;
    error = spread - 2.0 * std::abs(product);
    return motion;
}

// Outlines around the piece's own origin, as they are or mirrored, so that they turn the same way.
std::vector<std::vector<Vec2>> outlines_of(const PatternPiece& piece, bool mirrored) {
    std::vector<std::vector<Vec2>> outlines;
    for (Index l = 0; l < piece.path_count(); ++l) {
        outlines.push_back(piece.path(l).points);
        for (Vec2& p : outlines.back()) {
            p -= piece.box.center();
            if (mirrored)
                p.x() = -p.x();
        }
        if (mirrored)
            std::reverse(outlines.back().begin(), outlines.back().end());
    }
    return outlines;
}

// Whether all of `a`, moved, lies on an outline of `b`.
bool lies_on(const std::vector<std::vector<Vec2>>& a, const std::vector<std::vector<Vec2>>& b,
             const Motion& motion, double tolerance) {
    for (const std::vector<Vec2>& outline : a)
        for (const Vec2& p : outline) {
            const Vec2 moved = motion(p);
            bool near = false;
            for (const std::vector<Vec2>& other : b)
                near = near || (nearest_on(other, moved) - moved).norm() <= tolerance;
            if (!near)
                return false;
        }
    return true;
}

// Brings the points to the nearest ones of the other outline, again and again.
bool fits_from(const std::vector<std::vector<Vec2>>& a, const std::vector<std::vector<Vec2>>& b,
               const std::vector<Vec2>& even, Motion motion, double tolerance) {
    for (int round = 0; round < motion_rounds; ++round) {
        std::vector<Vec2> nearest;
        for (const Vec2& p : even)
            nearest.push_back(nearest_on(b.front(), motion(p)));
        double error = 0.0;
        motion = fit_motion(even, nearest, 0, error);
    }
    const Motion back{std::conj(motion.turn), -std::conj(motion.turn) * motion.shift};
    return lies_on(a, b, motion, tolerance) && lies_on(b, a, back, tolerance);
}

bool same_shape(const PatternPiece& piece, const PatternPiece& model, bool mirrored,
                double tolerance) {
    const std::vector<std::vector<Vec2>> a = outlines_of(piece, mirrored);
    const std::vector<std::vector<Vec2>> b = outlines_of(model, false);
    const std::vector<Vec2> from = even_points(a.front(), places);
    const std::vector<Vec2> to = even_points(b.front(), places);
    Motion best;
    double least = infinite;
    for (std::size_t offset = 0; offset < places; ++offset) {
        double error = 0.0;
        const Motion motion = fit_motion(from, to, offset, error);
        if (error < least) {
            least = error;
            best = motion;
        }
    }
    return fits_from(a, b, from, best, tolerance);
}

// What pieces of one shape agree on, however they are turned: cheap to compare.
struct Signature {
    double around = 0.0;      // length of the outline
    double mean_radius = 0.0; // root mean square distance of the outline from its centre
    double radius = 0.0;      // the largest
};

Signature signature_of(const PatternPiece& piece) {
    const std::vector<Vec2> points = even_points(piece.outer.points, places);
    Signature signature;
    signature.around = plane::perimeter(piece.outer.points);
    Vec2 centre = Vec2::Zero();
    for (const Vec2& p : points)
        centre += p / static_cast<double>(points.size());
    for (const Vec2& p : points)
        signature.mean_radius += (p - centre).squaredNorm() / static_cast<double>(points.size());
    signature.mean_radius = std::sqrt(signature.mean_radius);
    for (const Vec2& p : piece.outer.points)
        signature.radius = std::max(signature.radius, (p - centre).norm());
    return signature;
}

bool may_be_same(const PatternPiece& a, const PatternPiece& b, const Signature& of_a,
                 const Signature& of_b, double tolerance) {
    const auto near = [](double x, double y, double distance) {
        return std::abs(x - y) <= distance;
    };
    // Evenly spaced points of ragged outlines are not at the same places: twice the tolerance.
    // An outline that moves by d changes the area by d times its length at most.
    return a.holes.size() == b.holes.size() &&
           near(of_a.mean_radius, of_b.mean_radius, 2.0 * tolerance) &&
           near(of_a.radius, of_b.radius, 4.0 * tolerance) &&
           near(a.area, b.area, tolerance * std::max(of_a.around, of_b.around)) &&
           near(of_a.around, of_b.around, length_raggedness * of_a.around);
}

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

void set_sizes(PatternPiece& piece, GrainDirection grain) {
    const PieceBox box = least_box(piece.outer.points);
    piece.long_side = box.long_side;
    piece.short_side = box.short_side;
    piece.grain =
        chord_through(piece, piece.label_position,
                      grain == GrainDirection::longest ? box.direction : Vec2(Vec2::UnitY()));
}

void find_same_pieces(std::vector<PatternPiece>& pieces, double tolerance_mm) {
    std::vector<std::size_t> models;
    std::vector<Signature> signatures;
    for (const PatternPiece& piece : pieces)
        signatures.push_back(signature_of(piece));
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        PatternPiece& piece = pieces[i];
        piece.model = static_cast<Index>(i);
        piece.mirrored = false;
        piece.quantity = 1;
        piece.mirrored_quantity = 0;
        const double tolerance = std::min(tolerance_mm, size_share * std::sqrt(piece.area));
        for (const std::size_t m : models) {
            PatternPiece& model = pieces[m];
            if (!may_be_same(piece, model, signatures[i], signatures[m], tolerance))
                continue;
            const bool straight = same_shape(piece, model, false, tolerance);
            if (!straight && !same_shape(piece, model, true, tolerance))
                continue;
            piece.model = static_cast<Index>(m);
            piece.mirrored = !straight;
            piece.quantity = 0;
            ++(straight ? model.quantity : model.mirrored_quantity);
            break;
        }
        if (piece.quantity > 0)
            models.push_back(i);
    }
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
