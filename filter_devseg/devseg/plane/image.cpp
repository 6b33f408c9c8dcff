#include "devseg/plane/image.h"

#include <algorithm>
#include <cmath>

namespace devseg::plane {

namespace {

struct Between {
    std::size_t low;
    std::size_t high;
    double share; // of the high one
};

Between between(double place, int size) {
    const double period = static_cast<double>(size);
    if (!(place >= 0.0 && place < period)) // outside of the unit square, or no number
        place = std::min(std::max(0.0, place - period * std::floor(place / period)),
                         std::nextafter(period, 0.0));
    const auto low = static_cast<std::size_t>(place);
    return {low, low + 1 < static_cast<std::size_t>(size) ? low + 1 : 0,
            place - static_cast<double>(low)};
}

} // namespace

std::array<double, 3> sample(const Image& image, const Vec2& uv) {
    const Between x = between(uv.x() * image.width - 0.5, image.width);
    const Between y = between((1.0 - uv.y()) * image.height - 0.5, image.height);
    const auto width = static_cast<std::size_t>(image.width);
    const auto pixel = [&](std::size_t column, std::size_t row) {
        return image.rgb.data() + 3 * (row * width + column);
    };
    const std::array<const std::uint8_t*, 4> around = {pixel(x.low, y.low), pixel(x.high, y.low),
                                                       pixel(x.low, y.high), pixel(x.high, y.high)};
    std::array<double, 3> color{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double above = (1.0 - x.share) * around[0][k] + x.share * around[1][k];
        const double below = (1.0 - x.share) * around[2][k] + x.share * around[3][k];
        color[k] = (1.0 - y.share) * above + y.share * below;
    }
    return color;
}

Image halved(const Image& image) {
    Image small{std::max(1, image.width / 2), std::max(1, image.height / 2), {}};
    small.rgb.reserve(3 * static_cast<std::size_t>(small.width) *
                      static_cast<std::size_t>(small.height));
    const auto width = static_cast<std::size_t>(image.width);
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x)
            for (std::size_t k = 0; k < 3; ++k) {
                int sum = 0;
                for (const int row : {2 * y, std::min(2 * y + 1, image.height - 1)})
                    for (const int column : {2 * x, std::min(2 * x + 1, image.width - 1)})
                        sum += image.rgb[3 * (static_cast<std::size_t>(row) * width +
                                              static_cast<std::size_t>(column)) +
                                         k];
                small.rgb.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
            }
    return small;
}

} // namespace devseg::plane
