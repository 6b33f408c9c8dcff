#include "sheet/tabs.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"
#include "sheet/segment_grid.h"

namespace devseg::sheet {

namespace {

// A stretch of a seam may leave its chord by this much: paper bends that far along a tab.
constexpr double straightness = 0.4; // mm
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
    for (Index i = first + 1; i < last; ++i)
        if (plane::distance(side.point(i), side.point(first), side.point(last)) > straightness)
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
