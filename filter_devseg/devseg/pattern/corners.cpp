#include "devseg/pattern/corners.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>

#include "devseg/pattern/outlines.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Lines are fitted to stretches of so many edges of the mesh, within these shares of the outline's
// size: less shows its staircase, more belongs to the shape of the piece.
constexpr double reach_edges = 5.0;
constexpr double shortest_reach = 0.1;
constexpr double longest_reach = 0.18;

// A corner turns by this share of its angle within half of the reach as well; a bend that is
// rounded over the reach turns by half.
constexpr double sharpness = 0.7;

// Seams between corners, and between corners and junctions, are at least so long, as a share of
// the reach: less has no direction of its own on a ragged outline.
constexpr double least_seam = 0.7;

// Lines are as uncertain as a saw tooth is steep that leaves them as far as the outline does; a
// corner must turn by so many times that more.
constexpr double line_raggedness = 2.0;

// A line through a stretch of outline: its unit direction (0: there is none), and the slope of a
// straight line across it that would be off by as much in the mean square.
struct FittedLine {
    Vec2 direction = Vec2::Zero();
    double slope = 0.0;
};

// A polyline by its arc length, the points in a ring where it is closed.
class Polyline {
public:
    explicit Polyline(const std::vector<Vec2>& points)
        : points_(points), last_(static_cast<Index>(points.size()) - 1),
          closed_(points.front() == points.back()) {
        arc_.push_back(0.0);
        for (std::size_t i = 1; i < points.size(); ++i)
            arc_.push_back(arc_.back() + (points[i] - points[i - 1]).norm());
    }

    double length() const { return arc_.back(); }

    /// Distance of two points along the polyline, the shorter way round where it is closed.
    double between(Index i, Index j) const {
        const double d = std::abs(arc_[i] - arc_[j]);
        return closed_ ? std::min(d, length() - d) : d;
    }

    /// The line that fits best to the stretch of this length in front of point i (step −1) or
    /// behind it.
    FittedLine fit(Index i, double reach, int step) const {
        Vec2 sum = Vec2::Zero();
        Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
        double weight = 0.0;
        const Vec2 origin = points_[i];
        Vec2 here = Vec2::Zero();
        for (Index steps = 0; steps < last_ && weight < reach; ++steps) {
            Index next = i + step;
            if (next < 0 || next > last_) {
                if (!closed_)
                    break;
                next = next < 0 ? last_ - 1 : 1;
            }
            Vec2 along = points_[next] - origin - here;
            const double length = along.norm();
            if (length > reach - weight)
                along *= (reach - weight) / length;
            const double used = std::min(length, reach - weight);
            const Vec2 middle = here + 0.5 * along;
            sum += used * middle;
            squares += used * (middle * middle.transpose() + along * along.transpose() / 12.0);
            weight += used;
            here += along;
            i = next;
        }
        if (!(weight > 0.0))
            return {};
        const Eigen::Matrix2d spread = squares / weight - sum * sum.transpose() / (weight * weight);
        const double angle = 0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
        const Vec2 axis(std::cos(angle), std::sin(angle));
        const Vec2 across = plane::left_of(axis);
        const double off = std::sqrt(std::max(0.0, across.dot(spread * across)));
        return {step * axis.dot(here) >= 0.0 ? axis : Vec2(-axis), std::sqrt(12.0) * off / weight};
    }

    /// Whether the outline turns at point i by more than the angle and what its line_raggedness
    /// explains; `turn` is by how much.
    bool turns(Index i, double reach, double angle, double& turn) const {
        const FittedLine in = fit(i, reach, -1);
        const FittedLine out = fit(i, reach, 1);
        turn = plane::angle_between(in.direction, out.direction);
        turn -= line_raggedness * (in.slope + out.slope);
        return turn > angle;
    }

private:
    const std::vector<Vec2>& points_;
    Index last_;
    bool closed_;
    std::vector<double> arc_;
};

// The points of a chain, from its start: one polyline for each of its sides. Closed chains repeat
// their first point.
std::vector<std::vector<Vec2>> points_of(const std::vector<PatternPiece>& pieces,
                                         const Chain& chain) {
    std::vector<std::vector<Vec2>> sides(at(chain.side_count));
    for (std::size_t s = 0; s < sides.size(); ++s)
        for (Index k = 0; k <= chain.count(); ++k)
            sides[s].push_back(side_point(pieces, chain.sides[s], k));
    return sides;
}

// Size of the smaller outline that the chain lies on, mm.
double size_of(const std::vector<PatternPiece>& pieces, const Chain& chain) {
    double area = infinite;
    for (std::size_t s = 0; s < at(chain.side_count); ++s) {
        const SeamSide& side = chain.sides[s];
        area = std::min(area, std::abs(pieces[side.piece].path(side.path).area));
    }
    return std::sqrt(area);
}

std::vector<Index> corners_of(const std::vector<PatternPiece>& pieces, const Chain& chain,
                              double corner_angle) {
    const std::vector<std::vector<Vec2>> sides = points_of(pieces, chain);
    const double size = size_of(pieces, chain);
    const double edge = Polyline(sides.front()).length() / static_cast<double>(chain.count());
    return find_corners(sides,
                        std::clamp(reach_edges * edge, shortest_reach * size, longest_reach * size),
                        corner_angle);
}

// The tolerance holds for outlines of this size (the square root of the area, mm) and above, and in
// proportion for smaller ones: at 0.1 mm the areas of all pieces stay true to half a percent.
constexpr double full_size = 100.0;

// Cuts that were made to split a piece are straightened: along them, what one part loses the other
// gains, within this share of their size.
constexpr double cut_share = 0.05;

// The polylines while their vertices collapse.
class Collapse {
public:
    Collapse(const std::vector<std::vector<Vec2>>& sides, double tolerance)
        : sides_(sides), tolerance_(tolerance), size_(sides.front().size()), left_(size_),
          before_(size_), after_(size_), stamp_(size_, 0), inherited_(size_, 0.0), gone_(size_, 0) {
        for (std::size_t i = 0; i < size_; ++i) {
            before_[i] = i - 1;
            after_[i] = i + 1;
        }
        closed_ = sides.front().front() == sides.front().back();
    }

    std::vector<Index> run() {
        for (std::size_t i = 1; i + 1 < size_; ++i)
            push(i);
        const std::size_t least = closed_ ? 4 : 2;
        while (!queue_.empty() && left_ > least) {
            const auto [cost, i, stamp] = queue_.top();
            queue_.pop();
            if (gone_[i] != 0 || stamp != stamp_[i] || !may_go(i))
                continue;
            gone_[i] = 1;
            --left_;
            const std::size_t a = before_[i];
            const std::size_t b = after_[i];
            after_[a] = b;
            before_[b] = a;
            for (const std::size_t j : {a, b}) {
                inherited_[j] += 0.5 * cost;
                if (j > 0 && j + 1 < size_)
                    push(j);
            }
        }
        std::vector<Index> kept;
        for (std::size_t i = 0; i < size_; ++i)
            if (gone_[i] == 0)
                kept.push_back(static_cast<Index>(i));
        return kept;
    }

private:
    void push(std::size_t i) {
        double cost = inherited_[i];
        for (const std::vector<Vec2>& points : sides_)
            cost += plane::triangle_area(points[before_[i]], points[i], points[after_[i]]);
        queue_.emplace(cost, i, ++stamp_[i]);
    }

    bool may_go(std::size_t i) const {
        for (const std::vector<Vec2>& points : sides_)
            for (std::size_t k = before_[i] + 1; k < after_[i]; ++k)
                if (plane::distance(points[k], points[before_[i]], points[after_[i]]) > tolerance_)
                    return false;
        return true;
    }

    using Entry = std::tuple<double, std::size_t, int>; // cost, vertex, stamp

    const std::vector<std::vector<Vec2>>& sides_;
    double tolerance_;
    std::size_t size_;
    std::size_t left_;
    bool closed_ = false;
    std::vector<std::size_t> before_;
    std::vector<std::size_t> after_;
    std::vector<int> stamp_; // of the vertex's entry that counts
    std::vector<double> inherited_;
    std::vector<std::uint8_t> gone_;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue_;
};

// Edges of all outlines of a piece, from the left to the right.
struct OutlineSegment {
    Vec2 from;
    Vec2 to;
    double left;
    double right;
};

std::vector<OutlineSegment> segments_of(const PatternPiece& piece) {
    std::vector<OutlineSegment> segments;
    for (Index l = 0; l < piece.path_count(); ++l) {
        const std::vector<Vec2>& points = piece.path(l).points;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec2& a = points[i];
            const Vec2& b = points[(i + 1) % points.size()];
            segments.push_back({a, b, std::min(a.x(), b.x()), std::max(a.x(), b.x())});
        }
    }
    std::stable_sort(
        segments.begin(), segments.end(),
        [](const OutlineSegment& a, const OutlineSegment& b) { return a.left < b.left; });
    return segments;
}

double distance_to_line(const Vec2& p, const OutlineSegment& s) {
    const Vec2 along = s.to - s.from;
    return std::abs(plane::cross(along, p - s.from)) / along.norm();
}

// Two edges that cross.
bool is_deep(const OutlineSegment& a, const OutlineSegment& b, double depth) {
    return depth == 0.0 ||
           std::min({distance_to_line(a.from, b), distance_to_line(a.to, b),
                     distance_to_line(b.from, a), distance_to_line(b.to, a)}) > depth;
}

} // namespace

std::vector<Index> find_corners(const std::vector<std::vector<Vec2>>& sides, double reach,
                                double corner_angle) {
    const std::vector<Polyline> lines(sides.begin(), sides.end());
    const Index last = static_cast<Index>(sides.front().size()) - 1;
    const bool closed = sides.front().front() == sides.front().back();
    const double apart = least_seam * reach;
    std::vector<std::pair<double, Index>> found; // less the turn, point
    for (Index i = closed ? 0 : 1; i < last; ++i) {
        if (!closed && std::min(lines[0].between(0, i), lines[0].between(i, last)) < apart)
            continue;
        double most = 0.0;
        for (const Polyline& line : lines) {
            double turn = 0.0;
            double near_by = 0.0;
            if (line.turns(i, reach, corner_angle, turn) &&
                line.turns(i, 0.5 * reach, sharpness * corner_angle, near_by))
                most = std::max(most, turn);
        }
        if (most > 0.0)
            found.emplace_back(-most, i);
    }
    std::sort(found.begin(), found.end());
    std::vector<Index> corners;
    for (const auto& [turn, i] : found)
        if (std::all_of(corners.begin(), corners.end(),
                        [&, k = i](Index j) { return lines[0].between(k, j) >= apart; }))
            corners.push_back(i);
    std::sort(corners.begin(), corners.end());
    return corners;
}

std::vector<Chain> cut_at_corners(const std::vector<PatternPiece>& pieces,
                                  const std::vector<Chain>& chains, double corner_angle) {
    std::vector<Chain> result;
    for (const Chain& chain : chains) {
        std::vector<Index> ends;
        if (!chain.is_cut)
            ends = corners_of(pieces, chain, corner_angle);
        // A chain that ends where it begins, at a junction, has no corner there to be cut at.
        if (!chain.is_closed && !ends.empty() && ends.front() == 0)
            ends.erase(ends.begin());
        if (ends.empty()) {
            result.push_back(chain);
            continue;
        }
        if (chain.is_closed) {
            ends.push_back(ends.front() + chain.count());
        } else {
            ends.insert(ends.begin(), 0);
            ends.push_back(chain.count());
        }
        for (std::size_t i = 1; i < ends.size(); ++i)
            result.push_back(part_of(pieces, chain, ends[i - 1], ends[i]));
    }
    return result;
}

std::vector<Index> collapse_vertices(const std::vector<std::vector<Vec2>>& sides,
                                     double tolerance) {
    return Collapse(sides, tolerance).run();
}

void mark_corners(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                  double corner_angle) {
    for (PatternPiece& piece : pieces)
        for (Index l = 0; l < piece.path_count(); ++l)
            piece.path(l).corner.assign(piece.path(l).points.size(), 0);
    // Every end of a chain is the start of an edge of one: its own first, or the next one's.
    for (const Chain& chain : chains)
        for (std::size_t s = 0; s < at(chain.side_count); ++s) {
            const SeamSide& side = chain.sides[s];
            PiecePath& path = pieces[side.piece].path(side.path);
            const std::size_t size = path.points.size();
            const std::size_t i = at(side.first);
            if (!chain.is_closed && side.count > 0 &&
                plane::turn(path.points[(i + size - 1) % size], path.points[i],
                            path.points[(i + 1) % size]) > corner_angle)
                path.corner[i] = 1;
        }
}

void simplify_outlines(std::vector<PatternPiece>& pieces, std::vector<Chain>& chains,
                       double tolerance) {
    std::vector<std::vector<Index>> kept;
    for (const Chain& chain : chains) {
        const double size = size_of(pieces, chain);
        const double own =
            chain.is_cut ? cut_share * size : tolerance * std::min(1.0, size / full_size);
        kept.push_back(collapse_vertices(points_of(pieces, chain), own));
    }
    // Every round keeps all vertices of further pieces: this ends.
    std::vector<std::uint8_t> whole(pieces.size(), 0);
    for (std::size_t p = 0; p < pieces.size(); ++p)
        whole[p] = crosses_itself(pieces[p]) ? 1 : 0; // as it is, it is no better than simplified
    for (bool again = true; again;) {
        std::vector<PatternPiece> simple = pieces;
        std::vector<Chain> moved = chains;
        keep_points(simple, moved, kept);
        again = false;
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            if (whole[p] != 0 || !crosses_itself(simple[p]))
                continue;
            whole[p] = 1;
            again = true;
            for (std::size_t c = 0; c < chains.size(); ++c)
                for (std::size_t s = 0; s < at(chains[c].side_count); ++s)
                    if (at(chains[c].sides[s].piece) == p) {
                        kept[c].resize(at(chains[c].count()) + 1);
                        std::iota(kept[c].begin(), kept[c].end(), 0);
                    }
        }
        if (!again) {
            pieces = std::move(simple);
            chains = std::move(moved);
        }
    }
}

bool crosses_itself(const PatternPiece& piece, double depth) {
    const std::vector<OutlineSegment> segments = segments_of(piece);
    for (std::size_t i = 0; i < segments.size(); ++i)
        for (std::size_t j = i + 1; j < segments.size() && segments[j].left <= segments[i].right;
             ++j)
            if (plane::segments_cross(segments[i].from, segments[i].to, segments[j].from,
                                      segments[j].to) &&
                is_deep(segments[i], segments[j], depth))
                return true;
    return false;
}

} // namespace devseg::pattern
