// The program follows the compaction by linear programming of
//   Z. Li, V. Milenkovic: "Compaction and separation algorithms for non-convex polygons and their
//   applications", European Journal of Operational Research 84(3), 1995,
//   doi:10.1016/0377-2217(95)00021-H
// Here charts turn as well, and the moves are the least ones, which Hildreth's method finds:
//   C. Hildreth: "A quadratic programming procedure", Naval Research Logistics Quarterly 4(1),
//   1957, doi:10.1002/nav.3800040113
#include "devseg/pack/compaction.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "devseg/plane/plane.h"

namespace devseg::pack {

namespace {

constexpr double share_of_box = 0.9;       // in the badness
constexpr double least_distance = 5.0e-4;  // that is kept, as a share of the side
constexpr double distance_slack = 1.0e-4;  // kept in addition, as a share of the distance
constexpr double most_move = 0.45;         // of the least distance: outlines never cross
constexpr double push = 0.5;               // of the walls, in largest moves
constexpr double wall_inverse_mass = 0.3;  // walls give way less than charts
constexpr double bound_tolerance = 1.0e-3; // of the bounds, in largest moves
constexpr int compaction_rounds = 120;
constexpr int most_sweeps = 300;
constexpr int idle_rounds = 15;                // rounds without progress
constexpr double progress_step = 1e-4;         // that counts as progress, as a share
constexpr std::int64_t most_work = 20'000'000; // bounds and edges to look at
constexpr std::int64_t edge_work = 10;         // to place one and to find what is near

constexpr double box_cells = 128.0; // along the longer side of the box

// What is close to what in a layout: vertices of an outline and edges of others.
struct PlacedEdge {
    Vec2 from;
    Vec2 to;
    std::size_t chart;
};

// A vertex of chart a and the nearest point of chart b.
struct ClosePair {
    std::size_t a;
    std::size_t b;
    Vec2 at_a;
    Vec2 at_b;
    Vec2 normal; // from b to a, of length 1
    double distance;
};

class Proximity {
public:
    // All pairs at distances below `reach`, at most one for each vertex and other chart. `box`
    // holds the edges, whose charts are numbers below `charts`; each vertex begins one of them.
    const std::vector<ClosePair>& find(const std::vector<PlacedEdge>& edges,
                                       const Eigen::AlignedBox2d& box, std::size_t charts,
                                       double reach) {
        reach_ = reach;
        pairs_.clear();
        fill(edges, box);
        nearest_.assign(charts, {});
        for (std::size_t k = 0; k < edges.size(); ++k)
            find_near(edges, k);
        return pairs_;
    }

private:
    struct Nearest {
        double distance = 0.0; // squared
        std::size_t edge = 0;
        std::size_t vertex = 0; // of which this is true; from 1 on
    };

    void fill(const std::vector<PlacedEdge>& edges, const Eigen::AlignedBox2d& box) {
        low_ = box.min();
        cell_ = std::max(2.0 * reach_, box.sizes().maxCoeff() / box_cells);
        columns_ = static_cast<std::size_t>(box.sizes().x() / cell_) + 1;
        rows_ = static_cast<std::size_t>(box.sizes().y() / cell_) + 1;
        // Counting leaves room for one more start: filling moves them to the ends of their cells.
        starts_.assign(columns_ * rows_ + 2, 0);
        for (const PlacedEdge& e : edges)
            visit_cells(e, [&](std::size_t c) { ++starts_[c + 2]; });
        for (std::size_t c = 2; c < starts_.size(); ++c)
            starts_[c] += starts_[c - 1];
        listed_.resize(starts_.back());
        for (std::size_t k = 0; k < edges.size(); ++k)
            visit_cells(edges[k], [&](std::size_t c) { listed_[starts_[c + 1]++] = k; });
    }

    // Pairs with the vertex where an edge begins.
    void find_near(const std::vector<PlacedEdge>& edges, std::size_t vertex) {
        const Vec2& p = edges[vertex].from;
        const std::size_t chart = edges[vertex].chart;
        const std::size_t c = row(p.y()) * columns_ + column(p.x());
        near_.clear();
        for (std::size_t k = starts_[c]; k < starts_[c + 1]; ++k) {
            const PlacedEdge& other = edges[listed_[k]];
            if (other.chart == chart)
                continue;
            const double distance =
                (p - plane::nearest_point(p, other.from, other.to)).squaredNorm();
            if (!(distance < reach_ * reach_))
                continue;
            Nearest& nearest = nearest_[other.chart];
            const bool first = nearest.vertex != vertex + 1;
            if (first)
                near_.push_back(other.chart);
            if (first || distance < nearest.distance)
                nearest = {distance, listed_[k], vertex + 1};
        }
        for (const std::size_t b : near_) {
            const PlacedEdge& other = edges[nearest_[b].edge];
            const Vec2 q = plane::nearest_point(p, other.from, other.to);
            const double distance = (p - q).norm();
            Vec2 normal(0.0, 0.0);
            if (distance > 0.0) {
                normal = (p - q) / distance;
            } else {
                // They touch; the inside of an edge is on its left.
                normal = Vec2(other.to.y() - other.from.y(), other.from.x() - other.to.x());
                normal = normal.squaredNorm() > 0.0 ? Vec2(normal.normalized()) : Vec2(1.0, 0.0);
            }
            pairs_.push_back({chart, b, p, q, normal, distance});
        }
    }

    std::size_t column(double x) const {
        return static_cast<std::size_t>(
            std::clamp((x - low_.x()) / cell_, 0.0, static_cast<double>(columns_ - 1)));
    }

    std::size_t row(double y) const {
        return static_cast<std::size_t>(
            std::clamp((y - low_.y()) / cell_, 0.0, static_cast<double>(rows_ - 1)));
    }

    // The cells that the box of an edge, grown by the reach, touches.
    template <typename Visit>
    void visit_cells(const PlacedEdge& e, Visit visit) const {
        const Vec2 low = e.from.cwiseMin(e.to) - Vec2::Constant(reach_);
        const Vec2 high = e.from.cwiseMax(e.to) + Vec2::Constant(reach_);
        const std::size_t left = column(low.x());
        const std::size_t right = column(high.x());
        const std::size_t top = row(high.y());
        for (std::size_t y = row(low.y()); y <= top; ++y)
            for (std::size_t x = left; x <= right; ++x)
                visit(y * columns_ + x);
    }

    double reach_ = 0.0;
    Vec2 low_ = Vec2::Zero();
    double cell_ = 1.0;
    std::size_t columns_ = 1;
    std::size_t rows_ = 1;
    std::vector<std::size_t> starts_; // of the cells' parts of `listed_`
    std::vector<std::size_t> listed_; // edges
    std::vector<Nearest> nearest_;    // for each chart
    std::vector<std::size_t> near_;   // charts close to the present vertex
    std::vector<ClosePair> pairs_;
};

// A chart as a rigid body of mass 1.
struct Body {
    Vec2 centre = Vec2::Zero();   // about which it turns, in the chart's coordinates
    double inverse_inertia = 0.0; // 0: it does not turn
    double free_x = 1.0;          // 0: it keeps its x
    double radius = 0.0;          // of its farthest point
    Vec2 position = Vec2::Zero(); // of the centre
    double angle = 0.0;
    double cosine = 1.0;
    double sine = 0.0;

    Placement placement() const {
        return {cosine, sine, position - plane::turned(centre, cosine, sine)};
    }
};

Body make_body(const Outline& outline, const Placement& placement, bool allow_rotation) {
    Body body;
    const double count = static_cast<double>(outline.hull.size());
    for (const Vec2& p : outline.hull)
        body.centre += p / count;
    double inertia = 0.0;
    for (const Vec2& p : outline.hull) {
        body.radius = std::max(body.radius, (p - body.centre).norm());
        inertia += (p - body.centre).squaredNorm() / count;
    }
    if (allow_rotation && inertia > 0.0)
        body.inverse_inertia = 1.0 / inertia;
    body.position = placement(body.centre);
    body.cosine = placement.cosine;
    body.sine = placement.sine;
    body.angle = std::atan2(body.sine, body.cosine);
    return body;
}

struct Move {
    Vec2 shift = Vec2::Zero();
    double turn = 0.0;
};

// normal · (move of a − move of b) ≥ need, where the points of a and b have these arms.
struct Bound {
    std::size_t a = 0;
    std::size_t b = 0; // from the number of charts on: a wall
    Vec2 normal = Vec2::Zero();
    double arm_a = 0.0;
    double arm_b = 0.0;
    double need = 0.0;
    double inverse_mass = 0.0; // of both together, along the normal
    double impulse = 0.0;
};

class Compaction {
public:
    Compaction(const std::vector<Outline>& outlines, const std::vector<Placement>& placements,
               const PackOptions& options)
        : outlines_(outlines), padding_(options.padding) {
        for (std::size_t i = 0; i < outlines.size(); ++i)
            bodies_.push_back(make_body(outlines[i], placements[i], options.allow_rotation));
        measure();
    }
    Compaction(const std::vector<Outline>& outlines, const std::vector<Placement>& placements,
               const StripWalls& walls)
        : outlines_(outlines), padding_(0.0), walls_(&walls) {
        for (std::size_t i = 0; i < outlines.size(); ++i) {
            bodies_.push_back(make_body(outlines[i], placements[i], walls.may_turn[i] != 0));
            bodies_.back().free_x = walls.at_left[i] != 0 ? 0.0 : 1.0;
        }
        measure();
    }

    Vec2 size() const { return box_.sizes(); }
    std::int64_t work() const { return work_; }
    bool feasible() const {
        return least_ >= goal_ * (1.0 - 0.5 * distance_slack) && outside_ <= distance_slack * goal_;
    }

    std::vector<Placement> placements() const {
        std::vector<Placement> result;
        for (const Body& body : bodies_)
            result.push_back(body.placement());
        return result;
    }

    // The walls come closer only while all distances are kept.
    void step() {
        const std::size_t n = bodies_.size();
        const double most = most_move * least_;
        moves_.assign(n + 4, Move{});
        if (feasible()) {
            const double inward = push * most;
            for (std::size_t wall = 0; wall < 4; ++wall)
                if (walls_ == nullptr || wall % 2 == 1)
                    moves_[n + wall].shift = inward * wall_normal(wall);
        }
        for (int sweep = 0; sweep < most_sweeps && relax(bound_tolerance * most); ++sweep)
            ;
        for (std::size_t i = 0; i < n; ++i) {
            Body& body = bodies_[i];
            const Move& move = moves_[i];
            const double length = move.shift.norm() + std::abs(move.turn) * body.radius;
            const double scale = length > most ? most / length : 1.0;
            body.position += scale * move.shift;
            if (move.turn != 0.0) {
                body.angle += scale * move.turn;
                body.cosine = std::cos(body.angle);
                body.sine = std::sin(body.angle);
            }
        }
        measure();
    }

private:
    static Vec2 wall_normal(std::size_t wall) {
        const double sign = wall < 2 ? 1.0 : -1.0;
        return wall % 2 == 0 ? Vec2(sign, 0.0) : Vec2(0.0, sign);
    }

    // Lays out edges and hulls.
    void place() {
        edges_.clear();
        box_.setEmpty();
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const Placement placement = bodies_[i].placement();
            const Outline& outline = outlines_[i];
            box_.extend(plane::box_of(outline.hull, placement));
            for (const OutlineEdge& e : outline.edges)
                edges_.push_back({placement(e.from), placement(e.to), i});
            if (outline.edges.empty()) {
                const Vec2 p = placement(outline.hull.front());
                edges_.push_back({p, p, i});
            }
        }
    }

    // Finds all bounds, and the least distance of two charts as far as it matters.
    void measure() {
        place();
        const double side = size().maxCoeff() / (1.0 - padding_);
        const double wanted = walls_ != nullptr ? walls_->gap : padding_ * side;
        goal_ = std::max(wanted, least_distance * side) * (1.0 + distance_slack);
        if (walls_ != nullptr) {
            outside_ = std::max(-box_.min().x(), box_.max().x() - walls_->width);
            box_.min().x() = 0.0;
            box_.max().x() = walls_->width;
        }
        // Farther points cannot come too close in one round.
        const double reach = goal_ * (1.0 + 2.0 * most_move);
        least_ = reach;
        bounds_.clear();
        for (const ClosePair& pair : proximity_.find(edges_, box_, bodies_.size(), reach)) {
            least_ = std::min(least_, pair.distance);
            add(pair, goal_ - pair.distance);
        }
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const Placement placement = bodies_[i].placement();
            for (const Vec2& point : outlines_[i].hull)
                for (std::size_t wall = 0; wall < 4; ++wall) {
                    const Vec2 p = placement(point);
                    const Vec2 normal = wall_normal(wall);
                    const double distance = normal.dot(p - (wall < 2 ? box_.min() : box_.max()));
                    if (distance < reach)
                        add({i, bodies_.size() + wall, p, p, normal, distance}, -distance);
                }
        }
        work_ += edge_work * static_cast<std::int64_t>(edges_.size());
    }

    void add(const ClosePair& pair, double need) {
        Bound bound;
        bound.a = pair.a;
        bound.b = pair.b;
        bound.normal = pair.normal;
        bound.need = need;
        const Body& a = bodies_[pair.a];
        bound.arm_a = plane::cross(pair.at_a - a.position, pair.normal);
        bound.inverse_mass =
            mass_along(a, pair.normal) + bound.arm_a * bound.arm_a * a.inverse_inertia;
        if (pair.b < bodies_.size()) {
            const Body& b = bodies_[pair.b];
            bound.arm_b = plane::cross(pair.at_b - b.position, pair.normal);
            bound.inverse_mass +=
                mass_along(b, pair.normal) + bound.arm_b * bound.arm_b * b.inverse_inertia;
        } else {
            bound.inverse_mass += wall_mass(pair.b - bodies_.size());
        }
        if (bound.inverse_mass > 0.0)
            bounds_.push_back(bound);
    }

    double wall_mass(std::size_t wall) const {
        return walls_ != nullptr && wall % 2 == 0 ? 0.0 : wall_inverse_mass;
    }
    // The inverse of what the body weighs for moves along the unit normal.
    static double mass_along(const Body& body, const Vec2& normal) {
        return 1.0 - (1.0 - body.free_x) * normal.x() * normal.x();
    }
    static Vec2 freed(const Body& body, const Vec2& move) {
        return {body.free_x * move.x(), move.y()};
    }

    // One sweep of Hildreth's method over the bounds; true when one was missed by more than this.
    bool relax(double missed_by) {
        bool missed = false;
        for (Bound& bound : bounds_) {
            Move& a = moves_[bound.a];
            Move& b = moves_[bound.b];
            const double miss = bound.need - bound.normal.dot(a.shift - b.shift) -
                                bound.arm_a * a.turn + bound.arm_b * b.turn;
            const double change = std::max(-bound.impulse, miss / bound.inverse_mass);
            if (change == 0.0)
                continue;
            missed = missed || miss > missed_by;
            bound.impulse += change;
            a.shift += freed(bodies_[bound.a], change * bound.normal);
            a.turn += change * bound.arm_a * bodies_[bound.a].inverse_inertia;
            if (bound.b < bodies_.size()) {
                b.shift -= freed(bodies_[bound.b], change * bound.normal);
                b.turn -= change * bound.arm_b * bodies_[bound.b].inverse_inertia;
            } else {
                b.shift -= change * wall_mass(bound.b - bodies_.size()) * bound.normal;
            }
        }
        work_ += static_cast<std::int64_t>(bounds_.size());
        return missed;
    }

    const std::vector<Outline>& outlines_;
    double padding_;
    const StripWalls* walls_ = nullptr; // of a strip
    std::vector<Body> bodies_;
    std::vector<Move> moves_; // of the charts and of the four walls
    std::vector<PlacedEdge> edges_;
    Eigen::AlignedBox2d box_;
    Proximity proximity_;
    std::vector<Bound> bounds_;
    double goal_ = 0.0;                  // the distance to keep
    double least_ = 0.0, outside_ = 0.0; // distance up to the reach; how far charts stick out
    std::int64_t work_ = 0;
};

// Round by round, as long as `badness_of` the box gets less; `least` is that of `best`.
template <class Badness>
std::vector<Placement> tightened(Compaction compaction, std::vector<Placement> best, double least,
                                 Badness badness_of, const Progress& progress) {
    for (int round = 0, idle = 0; round < compaction_rounds && idle < idle_rounds;
         ++round, ++idle) {
        progress.check();
        if (compaction.work() > most_work)
            break;
        compaction.step();
        const double now = badness_of(compaction.size());
        if (!compaction.feasible() || now >= least)
            continue;
        if (now < least * (1.0 - progress_step))
            idle = 0;
        least = now;
        best = compaction.placements();
    }
    return best;
}

} // namespace

double badness(const Vec2& box) {
    const double square = box.maxCoeff() * box.maxCoeff();
    return std::pow(box.prod(), share_of_box) * std::pow(square, 1.0 - share_of_box);
}

std::vector<Placement> compact(const std::vector<Outline>& outlines,
                               const std::vector<Placement>& placements, const PackOptions& options,
                               const Progress& progress) {
    const Compaction compaction(outlines, placements, options);
    return tightened(compaction, placements, badness(compaction.size()), badness, progress);
}

std::vector<Placement> compact_strip(const std::vector<Outline>& outlines,
                                     const std::vector<Placement>& placements,
                                     const StripWalls& walls, const Progress& progress) {
    const Compaction compaction(outlines, placements, walls);
    const auto length = [](const Vec2& box) { return box.y(); };
    // Layouts that do not keep the distance are worse than any that does.
    const double least = compaction.feasible() ? length(compaction.size()) : infinite;
    return tightened(compaction, placements, least, length, progress);
}

} // namespace devseg::pack
