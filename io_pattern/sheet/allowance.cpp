// References
//   X. Chen, S. McMains: Polygon offsetting by computing winding numbers. ASME IDETC 2005: the raw
//   offset curve, and the parts of the plane around which it winds a positive number of times.
//   A. Johnson: Clipper 6.4.2, which takes these parts.
#include "sheet/allowance.h"

#include <algorithm>
#include <cmath>

#include <polyclipping/clipper.hpp>

#include "devseg/plane/plane.h"

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
                                bool is_hole) {
    std::vector<WidePoint> ring;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        const WidePoint next{path.points[i], i < path.edges.size()
                                                 ? widths.of(path.edges[i], is_hole)
                                                 : widths.seams};
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

} // namespace

double AllowanceWidths::of(const pattern::OutlineSeam& edge, bool in_hole) const {
    if (edge.seam < 0)
        return in_hole ? hole_hems : hems;
    if (edge.is_dart)
        return darts;
    const bool is_zip = std::find(zip_seams.begin(), zip_seams.end(), edge.seam) != zip_seams.end();
    return is_zip ? zips : seams;
}

std::vector<Ring> add_allowance(const pattern::PatternPiece& piece, const AllowanceWidths& widths,
                                CornerStyle corners) {
    const double width = widths.largest();
    const Vec2 centre = piece.box.center();
    const double grid = (piece.box.sizes().maxCoeff() + 2.0 * miter_limit * width) / grid_size;
    ClipperLib::Clipper clipper;
    for (Index i = 0; i < piece.path_count(); ++i) {
        const std::vector<WidePoint> ring = distinct(piece.path(i), widths, i > 0);
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

} // namespace devseg::sheet
