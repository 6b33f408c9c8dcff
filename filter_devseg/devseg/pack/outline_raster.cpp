#include "devseg/pack/outline_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace devseg {

namespace {

void set_bits(std::uint64_t* row, Index first, Index last) {
    for (Index word = first / 64; word <= last / 64; ++word) {
        std::uint64_t mask = ~std::uint64_t{0};
        if (word == first / 64)
            mask &= ~std::uint64_t{0} << (first % 64);
        if (word == last / 64)
            mask &= ~std::uint64_t{0} >> (63 - last % 64);
        row[word] |= mask;
    }
}

// The x range of a triangle within the slab low ≤ y ≤ high; empty when min > max.
std::pair<double, double> slab_range(const Vec2* corner, double low, double high) {
    double min_x = std::numeric_limits<double>::max();
    double max_x = std::numeric_limits<double>::lowest();
    const auto include = [&](double x) {
        min_x = std::min(min_x, x);
        max_x = std::max(max_x, x);
    };
    for (int k = 0; k < 3; ++k) {
        const Vec2& a = corner[k];
        const Vec2& b = corner[(k + 1) % 3];
        if (a.y() >= low && a.y() <= high)
            include(a.x());
        for (const double y : {low, high})
            if ((a.y() < y && b.y() > y) || (a.y() > y && b.y() < y))
                include(a.x() + (b.x() - a.x()) * ((y - a.y()) / (b.y() - a.y())));
    }
    return {min_x, max_x};
}

} // namespace

BitImage rasterize(const std::vector<Triangle>& faces, const std::vector<Vec2>& points,
                   double cell, double margin) {
    Vec2 high = Vec2::Zero();
    for (const Vec2& p : points)
        high = high.cwiseMax(p);
    const auto cells = [&](double length) {
        return static_cast<Index>(std::floor((length + margin) / cell)) + 1;
    };
    BitImage image(cells(high.x()), cells(high.y()));
    for (const Triangle& t : faces) {
        const Vec2 corner[3] = {points[at(t[0])], points[at(t[1])], points[at(t[2])]};
        const double low_y = std::min({corner[0].y(), corner[1].y(), corner[2].y()});
        const double high_y = std::max({corner[0].y(), corner[1].y(), corner[2].y()});
        const Index first_row =
            std::max(Index{0}, static_cast<Index>(std::floor((low_y - margin) / cell)));
        const Index last_row =
            std::min(image.height - 1, static_cast<Index>(std::floor((high_y + margin) / cell)));
        for (Index y = first_row; y <= last_row; ++y) {
            const auto [min_x, max_x] =
                slab_range(corner, y * cell - margin, (y + 1) * cell + margin);
            if (min_x > max_x)
                continue;
            set_bits(image.row(y),
                     std::max(Index{0}, static_cast<Index>(std::floor((min_x - margin) / cell))),
                     std::min(image.width - 1,
                              static_cast<Index>(std::floor((max_x + margin) / cell))));
        }
    }
    return image;
}

} // namespace devseg
