// Pictures of pixels, for textures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "devseg/base/numbers.h"

namespace devseg::plane {

using Color = std::array<std::uint8_t, 3>; // red, green, blue

struct Image {
    int width = 0;                 // pixels
    int height = 0;                // pixels
    std::vector<std::uint8_t> rgb; // 3 width height: red, green, blue, the top row first

    bool is_empty() const { return rgb.empty(); }
};

/// The colour at texture coordinates, v up, from 0 to 255: bilinear between the middles of pixels.
/// The image repeats outside of the unit square.
std::array<double, 3> sample(const Image& image, const Vec2& uv);

/// The image at half its size, each pixel the mean of those that it replaces.
Image halved(const Image& image);

} // namespace devseg::plane
