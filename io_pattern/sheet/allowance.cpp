// References
//   X. Chen, S. McMains: Polygon offsetting by computing winding numbers. ASME IDETC 2005: the raw
//   offset curve, and the parts of the plane around which it winds a positive number of times.
//   A. Johnson: Clipper 6.4.2, which takes these parts.
#include "sheet/allowance.h"

#include <algorithm>
#include <cmath>

#include <polyclipping/clipper.hpp>

#include "devseg/plane/plane.h"
#include "sheet/segment_grid.h"

namespace devseg::sheet {

namespace {

using Ring = std::vector<Vec2>;

// Clipper works on whole numbers: the coordinates may use this many, within its fast range.
constexpr double grid_size = 5e8;

// Corners of an outline that turns by less are points of a curve, and pointed in every style.
constexpr double smooth_cosine = 0.94; // 20 degrees

// A pointed corner ends at most this many widths away from the corner of the piece, which allows
// angles down to 60 degrees.
constexpr double miter_limit = 2.0;

constexpr double round_tolerance = 0.02; // mm between an arc and its chords

// Holes of the cut line below this many square widths are left over between two seams.
constexpr double least_hole = 1.0;

Vec2 outward(const Vec2& from, const Vec2& to) {
    const Vec2 d = to - from;
    return Vec2(d.y(), -d.x()) / d.norm();
}

// A point of an outline, and the width along the edge that starts there.
struct WidePoint {
    Vec2 point;
    double width;
};

std::vector<WidePoint> distinct(const pattern::PiecePath& path, const AllowanceWidths& widths,
                                double hems) {
    std::vector<WidePoint> ring;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        const pattern::OutlineSeam* edge = i < path.edges.size() ? &path.edges[i] : nullptr;
        const bool is_hem = edge != nullptr && edge->seam < 0;
        const bool is_dart = edge != nullptr && edge->is_dart;
        const WidePoint next{path.points[i], is_hem ? hems : is_dart ? widths.darts : widths.seams};
        if (!ring.empty() && next.point == ring.back().point)
            ring.back() = next;
        else
            ring.push_back(next);
    }
    while (ring.size() > 1 && ring.back().point == ring.front().point)
        ring.pop_back();
    return ring;
}

// Between the sides with the normals n and m and their widths.
void add_convex_corner(const Vec2& p, const Vec2& n, double in, const Vec2& m, double out,
                       CornerStyle style, Ring& curve) {
    const double cosine = n.dot(m);
    const double sine = plane::cross(n, m);
    const bool smooth = cosine >= smooth_cosine;
    if (in == out && (smooth || style == CornerStyle::miter) &&
        2.0 / (1.0 + cosine) <= miter_limit * miter_limit) {
        curve.push_back(p + in * (n + m) / (1.0 + cosine));
        return;
    }
    if (in != out && !smooth && style == CornerStyle::miter) {
        const Vec2 tip = Vec2(in * m.y() - out * n.y(), out * n.x() - in * m.x()) / sine;
        if (tip.norm() <= miter_limit * std::max(in, out)) {
            curve.push_back(p + tip);
            return;
        }
    }
    curve.push_back(p + in * n);
    if (style == CornerStyle::round && !(smooth && in != out)) {
        const double width = std::max(in, out);
        const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
        const double step = 2.0 * std::acos(1.0 - std::min(0.5, round_tolerance / width));
        const int count = static_cast<int>(std::ceil(angle / step));
        for (int i = 1; i < count; ++i) {
            const double share = static_cast<double>(i) / count;
            curve.push_back(p +
                            (in + share * (out - in)) * (Eigen::Rotation2Dd(angle * share) * n));
        }
    }
    curve.push_back(p + out * m);
}

// Runs beside the ring; at concave corners it turns back to the corner, so that what lies beyond
// both sides is wound around the wrong way and drops out.
Ring raw_curve(const std::vector<WidePoint>& ring, CornerStyle style) {
    Ring curve;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const WidePoint& before = ring[(i + ring.size() - 1) % ring.size()];
        const auto& [p, width] = ring[i];
        const Vec2 n = outward(before.point, p);
        const Vec2 m = outward(p, ring[(i + 1) % ring.size()].point);
        if (plane::cross(n, m) >= 0.0) {
            add_convex_corner(p, n, before.width, m, width, style, curve);
        } else {
            curve.push_back(p + before.width * n);
            curve.push_back(p);
            curve.push_back(p + width * m);
        }
    }
    return curve;
}

// A stretch of a seam may leave its chord by this much: paper bends that far along a tab. On short
// stretches it is this share of their length.
constexpr double straightness = 0.4; // mm
constexpr double straight_share = 0.1;
constexpr double side_angle = pi / 4.0;
// Two tabs that meet at a concave corner share the room between them.
constexpr double corner_share = 0.48;
constexpr double shares_of_depth[] = {1.0, 0.75, 0.5, 0.35, 0.2};
// Of the height of the triangle over the stretch that the tab's sides would meet in.
constexpr double truncation = 0.8;
// Sides start this far from the outline, as a share of their length, where they are tested.
constexpr double start_share = 1e-3;

struct Stretch {
    Index first = 0; // edge of the seam, counted from its start
    Index count = 0;
};

// One side of a seam with edges counted along the seam.
class Side {
public:
    Side(const pattern::Pattern& pattern, const pattern::SeamSide& side)
        : path_(pattern.pieces[side.piece].path(side.path)), side_(side) {}

    Index edge_count() const { return side_.count; }
    /// Point i of edge_count() + 1, in the direction of the seam.
    const Vec2& point(Index i) const {
        const Index step = side_.reversed ? side_.count - i : i;
        return path_.points[(side_.first + step) % size()];
    }
    /// The tab's place in the outline, without corners.
    GlueTab place(const Stretch& s) const {
        const Index step = side_.reversed ? side_.count - s.first - s.count : s.first;
        return {side_.piece, side_.path, (side_.first + step) % size(), s.count, {}};
    }

private:
    Index size() const { return static_cast<Index>(path_.points.size()); }

    const pattern::PiecePath& path_;
    const pattern::SeamSide& side_;
};

bool is_straight(const Side& side, Index first, Index last) {
    const double most =
        std::min(straightness, straight_share * (side.point(last) - side.point(first)).norm());
    for (Index i = first + 1; i < last; ++i)
        if (plane::distance(side.point(i), side.point(first), side.point(last)) > most)
            return false;
    return true;
}

std::vector<Stretch> divide(const std::vector<Side>& sides) {
    std::vector<Stretch> stretches;
    const Index count = sides.front().edge_count();
    for (Index first = 0; first < count;) {
        Index last = first + 1;
        const auto reaches = [&](const Side& side) { return is_straight(side, first, last + 1); };
        while (last < count && std::all_of(sides.begin(), sides.end(), reaches))
            ++last;
        stretches.push_back({first, last - first});
        first = last;
    }
    return stretches;
}

// Clockwise angle from u to v, 0 to 2 π: how far the outside of an outline is open at a corner.
double clockwise(const Vec2& u, const Vec2& v) {
    const double angle = plane::signed_angle(v, u);
    return angle > 0.0 ? angle : angle + 2.0 * pi;
}

class PieceRoom {
public:
    PieceRoom(const pattern::PatternPiece& piece, double depth)
        : piece_(piece), grid_(grown(piece.box, depth), std::max(depth, 1e-3 * size(piece.box))) {
        for (Index i = 0; i < piece.path_count(); ++i)
            rings_.push_back(piece.path(i).points);
        for (const std::vector<Vec2>& ring : rings_)
            grid_.add_ring(ring, 0);
    }

    /// Finds corners for a tab of at most this depth; false where there is no room.
    bool shape(GlueTab& tab, double depth) const {
        const std::vector<Vec2>& points = piece_.path(tab.path).points;
        const auto point = [&](Index i) { return points[i % static_cast<Index>(points.size())]; };
        const Index count = static_cast<Index>(points.size());
        const Vec2 a = point(tab.first);
        const Vec2 b = point(tab.first + tab.count);
        const Vec2 along = b - a;
        const double length = along.norm();
        if (!(length > 0.0))
            return false;
        const Vec2 before = point(tab.first + count - 1) - a;
        const Vec2 after = point(tab.first + tab.count + 1) - b;
        const double left = std::min(side_angle, corner_share * clockwise(along, before));
        const double right = std::min(side_angle, corner_share * clockwise(after, -along));
        const double spread = 1.0 / std::tan(left) + 1.0 / std::tan(right);
        if (depth * spread > truncation * length)
            return false;
        const Vec2 d = along / length;
        const Vec2 out(d.y(), -d.x());
        tab.corner = {a + depth / std::tan(left) * d + depth * out,
                      b - depth / std::tan(right) * d + depth * out};
        return is_free(a, b, tab.corner);
    }

    void take(const GlueTab& tab) {
        const std::vector<Vec2>& points = piece_.path(tab.path).points;
        const Vec2& a = points[tab.first];
        const Vec2& b = points[at(tab.first + tab.count) % points.size()];
        grid_.add(a, tab.corner[0], 0);
        grid_.add(tab.corner[0], tab.corner[1], 0);
        grid_.add(tab.corner[1], b, 0);
    }

private:
    // The three free edges run outside the piece from end to end: then so does the tab.
    bool is_free(const Vec2& a, const Vec2& b, const std::array<Vec2, 2>& corner) const {
        const Vec2 start = a + start_share * (corner[0] - a);
        const Vec2 end = b + start_share * (corner[1] - b);
        return !grid_.touches(start, corner[0], 1) && !grid_.touches(corner[0], corner[1], 1) &&
               !grid_.touches(corner[1], end, 1) && !plane::is_inside(rings_, corner[0]) &&
               !plane::is_inside(rings_, start) && !plane::is_inside(rings_, end);
    }
    static Eigen::AlignedBox2d grown(const Eigen::AlignedBox2d& box, double depth) {
        return {box.min() - Vec2::Constant(depth), box.max() + Vec2::Constant(depth)};
    }
    static double size(const Eigen::AlignedBox2d& box) { return box.sizes().maxCoeff(); }

    const pattern::PatternPiece& piece_;
    std::vector<std::vector<Vec2>> rings_;
    SegmentGrid grid_;
};

} // namespace

std::vector<Ring> add_allowance(const pattern::PatternPiece& piece, const AllowanceWidths& widths,
                                CornerStyle corners) {
    const double width = widths.largest();
    const Vec2 centre = piece.box.center();
    const double grid = (piece.box.sizes().maxCoeff() + 2.0 * miter_limit * width) / grid_size;
    ClipperLib::Clipper clipper;
    for (Index i = 0; i < piece.path_count(); ++i) {
        const double hems = i == 0 ? widths.hems : widths.hole_hems;
        const std::vector<WidePoint> ring = distinct(piece.path(i), widths, hems);
        ClipperLib::Path path;
        if (ring.size() < 3)
            continue;
        for (const Vec2& p : raw_curve(ring, corners)) {
            const Vec2 q = (p - centre) / grid;
            path.emplace_back(std::llround(q.x()), std::llround(q.y()));
        }
        clipper.AddPath(path, ClipperLib::ptSubject, true);
    }
    ClipperLib::Paths solution;
    clipper.Execute(ClipperLib::ctUnion, solution, ClipperLib::pftPositive,
                    ClipperLib::pftPositive);
    std::sort(solution.begin(), solution.end(),
              [](const ClipperLib::Path& a, const ClipperLib::Path& b) {
                  return ClipperLib::Area(a) > ClipperLib::Area(b);
              });
    std::vector<Ring> rings;
    for (const ClipperLib::Path& path : solution) {
        const double area = ClipperLib::Area(path) * grid * grid;
        if (!rings.empty() && area > -least_hole * width * width)
            continue;
        Ring ring;
        for (const ClipperLib::IntPoint& p : path)
            ring.push_back(centre +
                           grid * Vec2(static_cast<double>(p.X), static_cast<double>(p.Y)));
        rings.push_back(std::move(ring));
    }
    return rings;
}

std::vector<Ring> grown_rings(const std::vector<Ring>& rings, double distance) {
    const Eigen::AlignedBox2d box = plane::box_of(rings.front());
    const Vec2 centre = box.center();
    const double grid = (box.sizes().maxCoeff() + 2.0 * miter_limit * distance) / grid_size;
    ClipperLib::ClipperOffset offset(miter_limit);
    for (const Ring& ring : rings) {
        ClipperLib::Path path;
        for (const Vec2& p : ring) {
            const Vec2 q = (p - centre) / grid;
            path.emplace_back(std::llround(q.x()), std::llround(q.y()));
        }
        offset.AddPath(path, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
    }
    ClipperLib::Paths solution;
    offset.Execute(solution, distance / grid);
    std::stable_sort(solution.begin(), solution.end(),
                     [](const ClipperLib::Path& a, const ClipperLib::Path& b) {
                         return ClipperLib::Area(a) > ClipperLib::Area(b);
                     });
    std::vector<Ring> grown;
    for (const ClipperLib::Path& path : solution) {
        grown.emplace_back();
        for (const ClipperLib::IntPoint& p : path)
            grown.back().push_back(centre +
                                   grid * Vec2(static_cast<double>(p.X), static_cast<double>(p.Y)));
    }
    return grown;
}

GlueTabs make_tabs(const pattern::Pattern& pattern, double depth, Progress& progress) {
    std::vector<PieceRoom> rooms;
    for (const pattern::PatternPiece& piece : pattern.pieces)
        rooms.emplace_back(piece, depth);
    GlueTabs result;
    result.tabs.resize(pattern.pieces.size());
    const auto put = [&](const std::vector<Side>& sides, const Stretch& stretch) {
        for (const double share : shares_of_depth)
            for (const Side& side : sides) {
                GlueTab tab = side.place(stretch);
                if (!rooms[tab.piece].shape(tab, share * depth))
                    continue;
                rooms[tab.piece].take(tab);
                result.tabs[tab.piece].push_back(tab);
                return true;
            }
        return false;
    };
    for (std::size_t s = 0; s < pattern.seams.size(); ++s) {
        progress.update(static_cast<double>(s) / static_cast<double>(pattern.seams.size()));
        const pattern::Seam& seam = pattern.seams[s];
        std::vector<Side> sides;
        for (const pattern::SeamSide& side : seam.sides)
            if (side.count == seam.sides[0].count) // both sides have the same vertices
                sides.emplace_back(pattern, side);
        bool any = false;
        for (const Stretch& stretch : divide(sides))
            any = put(sides, stretch) || any;
        result.seams_without += any ? 0 : 1;
    }
    return result;
}

} // namespace devseg::sheet
