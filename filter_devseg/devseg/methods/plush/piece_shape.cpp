#include "devseg/methods/plush/piece_shape.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "devseg/methods/plush/tuning.h"
#include "devseg/plane/plane.h"

namespace devseg::plush {

namespace {

// The outline with fewer corners: steps of one length, and where it turns
// sharply into the piece, as at the tips of darts.
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
    Outline(const std::vector<Vec2>& outline, const std::vector<std::size_t>& kept) : swept_{0.0} {
        for (const std::size_t i : kept)
            corners_.push_back(outline[i]);
        for (std::size_t i = 0; i < corners_.size(); ++i)
            swept_.push_back(swept_.back() +
                             0.5 * plane::cross(corners_[i], corners_[(i + 1) % corners_.size()]));
    }

    // Lines below the limit, the narrowest first. They may leave the piece:
    // is_inside tells.
    std::vector<Neck> narrow_lines(double limit) const {
        std::vector<Neck> lines;
        for (std::size_t last = 2; last < corners_.size(); ++last)
            for (std::size_t first = 0; first + 1 < last; ++first) {
                const double part = area_between(first, last);
                const double smaller = std::min(part, swept_.back() - part);
                const double width = (corners_[last] - corners_[first]).norm();
                if (width < limit * std::sqrt(std::max(0.0, smaller)))
                    lines.push_back({width / std::sqrt(smaller), first, last});
            }
        std::sort(lines.begin(), lines.end(), [](const Neck& a, const Neck& b) {
            return std::tie(a.width, a.first, a.last) < std::tie(b.width, b.first, b.last);
        });
        return lines;
    }

    bool is_inside(const Neck& line) const {
        const Vec2& a = corners_[line.first];
        const Vec2& b = corners_[line.last];
        for (std::size_t i = 0; i < corners_.size(); ++i)
            if (plane::segments_cross(a, b, corners_[i], corners_[(i + 1) % corners_.size()]))
                return false;
        return plane::is_inside(corners_, 0.5 * (a + b));
    }

private:
    // Of the part from one corner on to a later one.
    double area_between(std::size_t first, std::size_t last) const {
        return swept_[last] - swept_[first] + 0.5 * plane::cross(corners_[last], corners_[first]);
    }

    std::vector<Vec2> corners_;
    std::vector<double> swept_; // area swept from the origin up to each corner
};

} // namespace

Neck narrowest_neck(const std::vector<Vec2>& outline, double limit) {
    const std::vector<std::size_t> kept = simplified(outline);
    const Outline piece(outline, kept);
    for (const Neck& line : piece.narrow_lines(limit))
        if (piece.is_inside(line))
            return {line.width, kept[line.first], kept[line.last]};
    return {limit, 0, 0};
}

} // namespace devseg::plush
