#include "sheet/tabs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "devseg/plane/plane.h"
#include "sheet/segment_grid.h"

namespace devseg::sheet {

namespace {

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
        return {side_.piece, side_.path, (side_.first + step) % size(), s.count, {}, false};
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
        : piece_(piece), grid_(grown(piece.box, depth), std::max(depth, 1e-3 * size(piece.box))),
          outline_(grid_) {
        for (Index i = 0; i < piece.path_count(); ++i)
            rings_.push_back(piece.path(i).points);
        for (const std::vector<Vec2>& ring : rings_)
            outline_.add_ring(ring, 0);
        grid_ = outline_;
    }

    /// Finds corners for a tab of this depth, or for a triangle that is lower, but not lower than
    /// `least`; false where there is no room.
    bool shape(GlueTab& tab, double depth, double least) const {
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
        if (depth * spread > truncation * length) {
            depth = std::min(depth, length / spread);
            if (depth < least)
                return false;
            const Vec2 foot = a + depth / std::tan(left) / length * along;
            tab.corner[0] = tab.corner[1] = foot + depth / length * Vec2(along.y(), -along.x());
            return is_free(a, b, tab.corner);
        }
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

    /// Whether a line that starts and ends on the outline runs within the piece.
    bool holds(const std::vector<Vec2>& line) const {
        for (std::size_t i = 1; i < line.size(); ++i) {
            const bool is_first = i == 1;
            const bool is_last = i + 1 == line.size();
            const Vec2 step = start_share * (line[i] - line[i - 1]);
            if (outline_.touches(is_first ? Vec2(line[0] + step) : line[i - 1],
                                 is_last ? Vec2(line[i] - step) : line[i], 1) ||
                !plane::is_inside(rings_, 0.5 * (line[i - 1] + line[i])))
                return false;
        }
        return true;
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
    SegmentGrid grid_;    // outlines and tabs
    SegmentGrid outline_; // outlines alone
};

class TabMaker {
public:
    TabMaker(const pattern::Pattern& pattern, const TabOptions& options)
        : pattern_(pattern), options_(options) {
        for (const pattern::PatternPiece& piece : pattern.pieces)
            rooms_.emplace_back(piece, options.depth);
        result_.tabs.resize(pattern.pieces.size());
    }

    void add_seam(const pattern::Seam& seam) {
        std::vector<Side> sides;
        for (const pattern::SeamSide& side : seam.sides)
            if (side.count == seam.sides[0].count) // both sides have the same vertices
                sides.emplace_back(pattern_, side);
        bool any = false;
        std::size_t turn = 0;
        for (const Stretch& stretch : divide(sides)) {
            if (options_.sides == TabSides::both) {
                for (std::size_t k = 0; k < sides.size(); ++k)
                    any = put(sides, {k}, stretch) || any;
                continue;
            }
            std::vector<std::size_t> order;
            for (std::size_t k = 0; k < sides.size(); ++k)
                order.push_back((k + turn) % sides.size());
            turn += options_.sides == TabSides::alternating ? 1 : 0;
            any = put(sides, order, stretch) || any;
        }
        result_.seams_without += any ? 0 : 1;
    }

    // Along the open borders of a piece.
    void add_borders(Index piece) {
        for (Index p = 0; p < pattern_.pieces[piece].path_count(); ++p) {
            const pattern::PiecePath& path = pattern_.pieces[piece].path(p);
            const auto count = static_cast<Index>(path.edges.size());
            const auto is_hem = [&](Index i) { return path.edges[i % count].seam < 0; };
            Index start = 0; // behind a seam, if there is one
            while (start < count && (!is_hem(start) || is_hem(start + count - 1)))
                ++start;
            start = start == count ? 0 : start;
            for (Index i = start; i < start + count;) {
                Index end = i;
                while (end < start + count && is_hem(end))
                    ++end;
                if (end > i)
                    add_hem({piece, p, i % count, end - i, false, 0.0, {}});
                i = end + (end == i ? 1 : 0);
            }
        }
    }

    GlueTabs take() { return std::move(result_); }

private:
    void add_hem(const pattern::SeamSide& hem) {
        const std::vector<Side> side{Side(pattern_, hem)};
        for (const Stretch& stretch : divide(side))
            if (put(side, {0}, stretch))
                result_.tabs[hem.piece].back().on_border = true;
    }

    // On the first of the sides where a tab of each depth has room.
    bool put(const std::vector<Side>& sides, const std::vector<std::size_t>& order,
             const Stretch& stretch) {
        const double least = shares_of_depth[std::size(shares_of_depth) - 1] * options_.depth;
        for (const double share : shares_of_depth)
            for (const std::size_t k : order) {
                GlueTab tab = sides[k].place(stretch);
                if (!rooms_[tab.piece].shape(tab, share * options_.depth, least))
                    continue;
                rooms_[tab.piece].take(tab);
                result_.tabs[tab.piece].push_back(tab);
                if (sides.size() > 1)
                    add_shadow(tab, sides[1 - k].place(stretch));
                return true;
            }
        return false;
    }

    void add_shadow(const GlueTab& tab, const GlueTab& other) {
        const auto end_of = [&](const GlueTab& stretch, Index i) {
            const std::vector<Vec2>& points =
                pattern_.pieces[stretch.piece].path(stretch.path).points;
            return points[at(stretch.first + i) % points.size()];
        };
        const Vec2 a = end_of(tab, 0);
        const Vec2 along = end_of(tab, tab.count) - a;
        const Vec2 from = end_of(other, other.count); // outlines run in opposite directions
        const Vec2 to = end_of(other, 0);
        const double turn = plane::signed_angle(along, to - from);
        TabShadow shadow{other.piece, {from}};
        for (const Vec2& corner : tab.corner)
            if (shadow.line.size() < 2 || corner != tab.corner[0])
                shadow.line.push_back(from +
                                      plane::turned(corner - a, std::cos(turn), std::sin(turn)));
        shadow.line.push_back(to);
        if (rooms_[other.piece].holds(shadow.line))
            result_.shadows.push_back(std::move(shadow));
    }

    const pattern::Pattern& pattern_;
    const TabOptions& options_;
    std::vector<PieceRoom> rooms_;
    GlueTabs result_;
};

} // namespace

GlueTabs make_tabs(const pattern::Pattern& pattern, const TabOptions& options, Progress& progress) {
    TabMaker maker(pattern, options);
    for (std::size_t s = 0; s < pattern.seams.size(); ++s) {
        progress.update(static_cast<double>(s) / static_cast<double>(pattern.seams.size()));
        maker.add_seam(pattern.seams[s]);
    }
    for (std::size_t p = 0; p < pattern.pieces.size() && options.borders; ++p)
        maker.add_borders(static_cast<Index>(p));
    return maker.take();
}

} // namespace devseg::sheet
