#include "devseg/methods/plush/seam_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "devseg/methods/plush/tuning.h"
#include "devseg/plane/plane.h"

namespace devseg::plush {

namespace {

// The outline with fewer corners: steps of one length, and where it turns sharply into the piece,
// as at the tips of darts.
std::vector<std::size_t> simplified(const std::vector<Vec2>& outline) {
    const std::size_t count = outline.size();
    const double step = plane::perimeter(outline) / tuning.outline_corners;
    std::vector<std::size_t> corners;
    double before = infinite;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2& p = outline[i];
        const Vec2 in = p - outline[(i + count - 1) % count];
        const Vec2 out = outline[(i + 1) % count] - p;
        if (before >= step || plane::signed_angle(in, out) < -tuning.outline_notch) {
            corners.push_back(i);
            before = 0.0;
        }
        before += out.norm();
    }
    return corners;
}

class Outline {
public:
    explicit Outline(std::vector<Vec2> corners) : corners_(std::move(corners)), swept_{0.0} {
        for (std::size_t i = 0; i < corners_.size(); ++i)
            swept_.push_back(swept_.back() +
                             0.5 * plane::cross(corners_[i], corners_[(i + 1) % corners_.size()]));
    }

    double area() const { return std::max(0.0, swept_.back()); }
    // Of the part from one corner on to a later one.
    double area_between(std::size_t first, std::size_t last) const {
        return swept_[last] - swept_[first] + 0.5 * plane::cross(corners_[last], corners_[first]);
    }

    // The parts on narrow necks, those that lack most first. A line may leave the piece: is_inside
    // tells.
    std::vector<Neck> narrow_parts(double wide_enough) const {
        std::vector<Neck> parts;
        for (std::size_t last = 2; last < corners_.size(); ++last)
            for (std::size_t first = 0; first + 1 < last; ++first) {
                const double part = area_between(first, last);
                const double smaller = std::min(part, area() - part);
                const double lacking = wide_enough * std::sqrt(std::max(0.0, smaller)) -
                                       (corners_[last] - corners_[first]).norm();
                if (lacking > tuning.tiny)
                    parts.push_back({lacking, first, last});
            }
        std::sort(parts.begin(), parts.end(), [](const Neck& a, const Neck& b) {
            return std::make_tuple(-a.lacking, a.first, a.last) <
                   std::make_tuple(-b.lacking, b.first, b.last);
        });
        return parts;
    }

    bool is_inside(const Neck& part) const {
        const Vec2& a = corners_[part.first];
        const Vec2& b = corners_[part.last];
        for (std::size_t i = 0; i < corners_.size(); ++i)
            if (plane::segments_cross(a, b, corners_[i], corners_[(i + 1) % corners_.size()]))
                return false;
        return plane::is_inside(corners_, 0.5 * (a + b));
    }

    // Whether the corner belongs to the smaller part, its ends included.
    bool holds(const Neck& part, std::size_t corner) const {
        const bool is_inner = 2.0 * area_between(part.first, part.last) <= area();
        return is_inner ? corner >= part.first && corner <= part.last
                        : corner <= part.first || corner >= part.last;
    }

    bool holds_any(const Neck& part, const std::vector<std::uint8_t>& marks) const {
        for (std::size_t i = 0; i < corners_.size(); ++i)
            if (marks[i] != 0 && holds(part, i))
                return true;
        return false;
    }

    // The corners of the smaller part, and those beside its neck, within the width that it lacks.
    void take(const Neck& part, std::vector<std::uint8_t>& marks) const {
        const Vec2& a = corners_[part.first];
        const Vec2& b = corners_[part.last];
        const double near = part.lacking + (a - b).norm();
        for (std::size_t i = 0; i < corners_.size(); ++i)
            if (holds(part, i) || plane::distance(corners_[i], a, b) < near)
                marks[i] = 1;
    }

    std::size_t size() const { return corners_.size(); }

private:
    std::vector<Vec2> corners_;
    std::vector<double> swept_; // area swept from the origin up to each corner
};

} // namespace

std::vector<Neck> find_necks(const std::vector<Vec2>& outline, double wide_enough) {
    const std::vector<std::size_t> kept = simplified(outline);
    std::vector<Vec2> corners;
    for (const std::size_t i : kept)
        corners.push_back(outline[i]);
    const Outline piece(std::move(corners));
    std::vector<Neck> necks;
    std::vector<std::uint8_t> taken(piece.size(), 0); // beyond a neck that counts already
    for (const Neck& part : piece.narrow_parts(wide_enough)) {
        if (taken[part.first] != 0 || taken[part.last] != 0 || piece.holds_any(part, taken) ||
            !piece.is_inside(part))
            continue;
        necks.push_back({part.lacking, kept[part.first], kept[part.last]});
        piece.take(part, taken);
    }
    return necks;
}

double narrowness(const std::vector<Vec2>& outline, double wide_enough) {
    double sum = 0.0;
    for (const Neck& neck : find_necks(outline, wide_enough))
        sum += neck.lacking;
    return sum;
}

} // namespace devseg::plush
