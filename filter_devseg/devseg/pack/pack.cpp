#include "devseg/pack/pack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "devseg/errors.h"
#include "devseg/pack/outline_raster.h"

namespace devseg {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr Index resolution = 512;      // cells along the side of a fully used square
constexpr double optimistic_use = 0.9; // share of the square that no packing of charts exceeds
constexpr double search_ratio = 1.01;  // the side is searched up to this factor

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
    BitImage image;
};

struct Sheet {
    explicit Sheet(Index side) : image(side, side), free_from(0) {}

    BitImage image;
    Index free_from; // rows from here on are empty

    bool collides(const BitImage& chart, Index x, Index y) const {
        const Index word = x / 64;
        const int shift = x % 64;
        const Index last = std::min(chart.height, free_from - y);
        for (Index r = 0; r < last; ++r) {
            const std::uint64_t* used = image.row(y + r) + word;
            const std::uint64_t* bits = chart.row(r);
            std::uint64_t carry = 0;
            for (Index w = 0; w < chart.words; ++w) {
                const std::uint64_t low = (bits[w] << shift) | carry;
                if ((used[w] & low) != 0)
                    return true;
                carry = shift == 0 ? 0 : bits[w] >> (64 - shift);
            }
            if (carry != 0 && (used[chart.words] & carry) != 0)
                return true;
        }
        return false;
    }
    void occupy(const BitImage& chart, Index x, Index y) {
        const Index word = x / 64;
        const int shift = x % 64;
        for (Index r = 0; r < chart.height; ++r) {
            std::uint64_t* used = image.row(y + r) + word;
            const std::uint64_t* bits = chart.row(r);
            for (Index w = 0; w < chart.words; ++w) {
                used[w] |= bits[w] << shift;
                if (shift != 0 && (bits[w] >> (64 - shift)) != 0)
                    used[w + 1] |= bits[w] >> (64 - shift);
            }
        }
        free_from = std::max(free_from, y + chart.height);
    }
};

struct Spot {
    Index pose = 0;
    Index x = 0;
    Index y = 0;
    Index top = std::numeric_limits<Index>::max(); // of the placed image
};

// The place with the lowest top, then the leftmost, over all poses.
std::optional<Spot> find_spot(const Sheet& sheet, const std::vector<Pose>& poses) {
    std::optional<Spot> best;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const BitImage& chart = poses[i].image;
        const Index limit = best ? best->top - 1 : sheet.image.height;
        bool found = false;
        for (Index y = 0; y + chart.height <= limit && !found; ++y)
            for (Index x = 0; x + chart.width <= sheet.image.width; ++x)
                if (!sheet.collides(chart, x, y)) {
                    best = Spot{static_cast<Index>(i), x, y, y + chart.height};
                    found = true;
                    break;
                }
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
        for (const PackItem& item : items)
            area += area_of(item);
        const double side = std::sqrt(std::max(area, std::numeric_limits<double>::min()));
        cell_ = side / resolution;
        const double margin = 0.5 * options.padding * side * side_guess;
        for (const PackItem& item : items) {
            poses_.push_back(make_poses(item, options.allow_rotation, margin));
            progress_.update(0.3 * static_cast<double>(poses_.size()) /
                             static_cast<double>(items.size()));
        }
        order_.resize(items.size());
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        const auto size = [&](std::size_t i) {
            const BitImage& image = poses_[i].front().image;
            return std::max(image.width, image.height) + image.width + image.height;
        };
        std::stable_sort(order_.begin(), order_.end(),
                         [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    }

    std::vector<Placement> run() {
        // Grow until all fit, then halve the interval between too small and large enough.
        double low = resolution / std::sqrt(optimistic_use);
        double high = low;
        std::vector<Placement> best = try_side(static_cast<Index>(high));
        while (best.empty()) {
            low = high;
            high *= 1.1;
            best = try_side(static_cast<Index>(std::ceil(high)));
        }
        while (high > search_ratio * low) {
            const double middle = std::sqrt(low * high);
            std::vector<Placement> found = try_side(static_cast<Index>(std::ceil(middle)));
            if (found.empty()) {
                low = middle;
            } else {
                high = middle;
                best = std::move(found);
            }
        }
        return best;
    }

private:
    std::vector<Pose> make_poses(const PackItem& item, bool allow_rotation, double margin) const {
        const Placement base = allow_rotation ? best_box(item) : Placement{};
        std::vector<Pose> poses;
        for (int quarter = 0; quarter < (allow_rotation ? 4 : 1); ++quarter) {
            Pose pose;
            const double angle = 0.5 * pi * quarter;
            const double c = std::round(std::cos(angle));
            const double s = std::round(std::sin(angle));
            pose.placement.cosine = c * base.cosine - s * base.sine;
            pose.placement.sine = s * base.cosine + c * base.sine;
            std::vector<Vec2> points;
            Vec2 low = Vec2::Constant(std::numeric_limits<double>::max());
            for (const Vec2& p : *item.points) {
                points.push_back(pose.placement(p));
                low = low.cwiseMin(points.back());
            }
            pose.placement.offset = Vec2::Constant(margin) - low;
            for (Vec2& p : points)
                p += pose.placement.offset;
            pose.image = rasterize(*item.faces, points, cell_, margin);
            poses.push_back(std::move(pose));
        }
        return poses;
    }

    // Empty when not all charts fit.
    std::vector<Placement> try_side(Index side) {
        Sheet sheet(side);
        std::vector<Placement> placements(poses_.size());
        for (const std::size_t i : order_) {
            progress_.update(0.3);
            const std::optional<Spot> spot = find_spot(sheet, poses_[i]);
            if (!spot)
                return {};
            const Pose& pose = poses_[i][at(spot->pose)];
            sheet.occupy(pose.image, spot->x, spot->y);
            placements[i] = pose.placement;
            placements[i].offset += cell_ * Vec2(spot->x, spot->y);
        }
        return placements;
    }

    Progress& progress_;
    double cell_ = 0.0;
    std::vector<std::vector<Pose>> poses_;
    std::vector<std::size_t> order_; // largest first
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
