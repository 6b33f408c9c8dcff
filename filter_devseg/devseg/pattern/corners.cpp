#include "devseg/pattern/corners.h"

#include <algorithm>
#include <cmath>

#include "devseg/pattern/simplify.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Lines are fitted to stretches of so many edges of the mesh, within these shares of the outline's
// size: less shows its staircase, more belongs to the shape of the piece.
constexpr double reach_edges = 5.0;
constexpr double least_reach = 0.1;
constexpr double most_reach = 0.18;

// A corner turns by this share of its angle within half of the reach as well; a bend that is
// rounded over the reach turns by half.
constexpr double sharpness = 0.7;

// Seams between corners, and between corners and junctions, are at least so long, as a share of
// the reach: less has no direction of its own on a ragged outline.
constexpr double least_seam = 0.7;

// Lines are as uncertain as a saw tooth is steep that leaves them as far as the outline does; a
// corner must turn by so many times that more.
constexpr double raggedness = 2.0;

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

    /// Whether the outline turns at point i by more than the angle and what its raggedness
    /// explains; `turn` is by how much.
    bool turns(Index i, double reach, double angle, double& turn) const {
        const FittedLine in = fit(i, reach, -1);
        const FittedLine out = fit(i, reach, 1);
        turn = plane::angle_between(in.direction, out.direction);
        turn -= raggedness * (in.slope + out.slope);
        return turn > angle;
    }

private:
    const std::vector<Vec2>& points_;
    Index last_;
    bool closed_;
    std::vector<double> arc_;
};

std::vector<Index> corners_of(const std::vector<PatternPiece>& pieces, const Chain& chain,
                              double corner_angle) {
    const std::vector<std::vector<Vec2>> sides = points_of(pieces, chain);
    const double size = size_of(pieces, chain);
    const double edge = Polyline(sides.front()).length() / static_cast<double>(chain.count());
    return find_corners(
        sides, std::clamp(reach_edges * edge, least_reach * size, most_reach * size), corner_angle);
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

} // namespace devseg::pattern
