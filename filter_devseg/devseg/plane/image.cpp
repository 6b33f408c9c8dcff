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
    const double floor = std::floor(place);
    const double period = static_cast<double>(size);
    const auto low = static_cast<std::size_t>(
        std::min(floor - period * std::floor(floor / period), period - 1.0));
    return {low, (low + 1) % static_cast<std::size_t>(size), place - floor};
}

} // namespace

std::array<double, 3> sample(const Image& image, const Vec2& uv) {
    const Between x = between(uv.x() * image.width - 0.5, image.width);
    const Between y = between((1.0 - uv.y()) * image.height - 0.5, image.height);
    const auto width = static_cast<std::size_t>(image.width);
    std::array<double, 3> color{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto pixel = [&](std::size_t column, std::size_t row) {
            return static_cast<double>(image.rgb[3 * (row * width + column) + k]);
        };
        const double above = (1.0 - x.share) * pixel(x.low, y.low) + x.share * pixel(x.high, y.low);
        const double below =
            (1.0 - x.share) * pixel(x.low, y.high) + x.share * pixel(x.high, y.high);
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
