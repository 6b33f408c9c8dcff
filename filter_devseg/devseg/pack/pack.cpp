#include "devseg/pack/pack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "devseg/errors.h"
#include "devseg/pack/sheet.h"

namespace devseg {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr Index resolution = 512;      // cells along the side of a fully used square
constexpr double optimistic_use = 0.9; // share of the square that no packing of charts exceeds
constexpr double search_ratio = 1.004; // the side is searched up to this factor
constexpr int strategies = 4;          // orders of the charts that are tried

double area_of(const PackItem& item) {
    double twice = 0.0;
    for (const Triangle& t : *item.faces) {
        const Vec2 p = (*item.points)[at(t[1])] - (*item.points)[at(t[0])];
        const Vec2 q = (*item.points)[at(t[2])] - (*item.points)[at(t[0])];
        twice += std::abs(p.x() * q.y() - p.y() * q.x());
    }
    return 0.5 * twice;
}

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Andrew's monotone chain, counterclockwise.
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    std::vector<Vec2> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t start = hull.size();
        for (const Vec2& p : points) {
            while (hull.size() >= start + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

// The rotation after which the bounding box has the least area: one of its sides then lies on an
// edge of the convex hull.
Placement best_box(const PackItem& item) {
    const std::vector<Vec2> hull = convex_hull(*item.points);
    Placement best;
    double best_area = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
        const double length = edge.norm();
        if (!(length > 0.0))
            continue;
        Placement turn;
        turn.cosine = edge.x() / length;
        turn.sine = -edge.y() / length;
        Vec2 low = turn(hull.front());
        Vec2 high = low;
        for (const Vec2& p : hull) {
            low = low.cwiseMin(turn(p));
            high = high.cwiseMax(turn(p));
        }
        const double area = (high - low).prod();
        if (area < best_area) {
            best_area = area;
            best = turn;
        }
    }
    return best;
}

// One chart in one orientation.
struct Pose {
    Placement placement; // corner of the image at the origin
    ChartCells cells;
};

struct PosedSpot {
    std::size_t pose = 0;
    Spot spot;
};

// The place with the lowest top over all poses.
std::optional<PosedSpot> find_spot(const Sheet& sheet, const std::vector<Pose>& poses,
                                   Index height) {
    std::optional<PosedSpot> best;
    Index limit = height;
    for (std::size_t i = 0; i < poses.size(); ++i)
        if (const auto spot = sheet.find_lowest(poses[i].cells, limit)) {
            best = PosedSpot{i, *spot};
            limit = spot->y + poses[i].cells.height - 1;
        }
    return best;
}

class Packer {
public:
    /// `side_guess`: side of the final square in units of the side that the charts' area needs.
    Packer(const std::vector<PackItem>& items, const PackOptions& options, double side_guess,
           Progress& progress)
        : progress_(progress) {
        double area = 0.0;
        for (const PackItem& item : items) {
            area_.push_back(area_of(item));
            area += area_.back();
        }
        const double side = std::sqrt(std::max(area, std::numeric_limits<double>::min()));
        cell_ = side / resolution;
        const double margin = 0.5 * options.padding * side * side_guess;
        for (const PackItem& item : items) {
            poses_.push_back(make_poses(item, options.allow_rotation, margin));
            progress_.update(0.3 * static_cast<double>(poses_.size()) /
                             static_cast<double>(items.size()));
        }
        for (int strategy = 0; strategy < strategies; ++strategy)
            orders_.push_back(make_order(strategy));
    }

    std::vector<Placement> run() {
        double high = resolution / std::sqrt(optimistic_use);
        while (!improve(high))
            high *= 1.1;
        // Shrink the square as long as some order of the charts still fits.
        for (double step = 1.08; step > search_ratio;) {
            if (improve(high / step))
                high /= step;
            else
                step = std::sqrt(step);
        }
        return best_;
    }

private:
    std::vector<Pose> make_poses(const PackItem& item, bool allow_rotation, double margin) const {
        const Placement base = allow_rotation ? best_box(item) : Placement{};
        std::vector<Pose> poses;
        for (int quarter = 0; quarter < (allow_rotation ? 4 : 1); ++quarter) {
            Placement placement;
            const double angle = 0.5 * pi * quarter;
            const double c = std::round(std::cos(angle));
            const double s = std::round(std::sin(angle));
            placement.cosine = c * base.cosine - s * base.sine;
            placement.sine = s * base.cosine + c * base.sine;
            std::vector<Vec2> points;
            Vec2 low = Vec2::Constant(std::numeric_limits<double>::max());
            for (const Vec2& p : *item.points) {
                points.push_back(placement(p));
                low = low.cwiseMin(points.back());
            }
            placement.offset = Vec2::Constant(margin) - low;
            for (Vec2& p : points)
                p += placement.offset;
            poses.push_back({placement, ChartCells(rasterize(*item.faces, points, cell_, margin))});
        }
        return poses;
    }

    // Charts from the largest to the smallest, by one of several notions of size: which one packs
    // best depends on the shapes.
    std::vector<std::size_t> make_order(int strategy) const {
        const auto size = [&](std::size_t i) {
            const ChartCells& cells = poses_[i].front().cells;
            const double longer = std::max(cells.width, cells.height);
            const double shorter = std::min(cells.width, cells.height);
            switch (strategy) {
            case 0: return longer + 0.5 * shorter;
            case 1: return longer * shorter;
            case 2: return longer;
            default: return area_[i];
            }
        };
        std::vector<std::size_t> order(poses_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
        return order;
    }

    bool improve(double side) {
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            if (try_order(orders_[i], static_cast<Index>(std::ceil(side)))) {
                // What worked is tried first the next time.
                std::rotate(orders_.begin(), orders_.begin() + static_cast<std::ptrdiff_t>(i),
                            orders_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
                return true;
            }
        }
        return false;
    }

    bool try_order(const std::vector<std::size_t>& order, Index side) {
        Sheet sheet(side, side);
        std::vector<Placement> placements(poses_.size());
        for (const std::size_t i : order) {
            progress_.update(0.3);
            const std::optional<PosedSpot> found = find_spot(sheet, poses_[i], side);
            if (!found)
                return false;
            const Pose& pose = poses_[i][found->pose];
            sheet.occupy(pose.cells, found->spot);
            placements[i] = pose.placement;
            placements[i].offset += cell_ * Vec2(found->spot.x, found->spot.y);
        }
        best_ = std::move(placements);
        return true;
    }

    Progress& progress_;
    double cell_ = 0.0;
    std::vector<double> area_; // of each chart
    std::vector<std::vector<Pose>> poses_;
    std::vector<std::vector<std::size_t>> orders_;
    std::vector<Placement> best_;
};

} // namespace

PackResult pack_charts(const std::vector<PackItem>& items, const PackOptions& options,
                       Progress& progress) {
    if (!(options.padding >= 0.0) || !(options.padding <= 0.1))
        throw InvalidParameter("padding: expected a share of the square's side from 0 to 0.1, "
                               "found " + std::to_string(options.padding));
    PackResult result;
    if (items.empty())
        return result;
    double area = 0.0;
    for (const PackItem& item : items)
        area += area_of(item);
    Vec2 low;
    // The distance to keep is a share of a side that is only known afterwards: guess, and pack
    // again in the rare case that the guess was too small.
    double guess = 1.3;
    do {
        result.placements = Packer(items, options, guess, progress).run();
        low = Vec2::Constant(std::numeric_limits<double>::max());
        Vec2 high = -low;
        for (std::size_t i = 0; i < items.size(); ++i)
            for (const Vec2& p : *items[i].points) {
                low = low.cwiseMin(result.placements[i](p));
                high = high.cwiseMax(result.placements[i](p));
            }
        // The border of the square keeps half of the padding as well.
        result.side = (high - low).maxCoeff() / (1.0 - options.padding);
        guess *= 1.3;
    } while (guess / 1.3 * std::sqrt(area) < result.side && options.padding > 0.0);
    const Vec2 shift = Vec2::Constant(0.5 * options.padding * result.side) - low;
    for (Placement& placement : result.placements)
        placement.offset += shift;
    return result;
}

} // namespace devseg
