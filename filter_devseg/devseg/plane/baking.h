// Triangles with what they look like → an image of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "devseg/base/numbers.h"
#include "devseg/plane/image.h"

namespace devseg::plane {

/// A triangle with the colours of an image, or with those of its corners between which they run
/// evenly.
struct BakedTriangle {
    std::array<Vec2, 3> place{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()}; // pixels, y up
    const Image* source = nullptr;                                       // or none
    std::array<Vec2, 3> uv{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};    // in `source`
    std::array<Vec3, 3> color{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}; // 0 to 255
};

/// Black where nothing is painted.
class Baking {
public:
    Baking(int width, int height);

    /// Paints all pixels whose middles lie within `reach` pixels of the triangle, unless another
    /// one was as near. Coordinates that are not finite paint nothing.
    void add(const BakedTriangle& triangle, double reach);

    /// Gives pixels at most about `reach` pixels away from painted ones the colour of the nearest
    /// of them, and others `far`.
    void spread(double reach, const Color& far);

    /// Share of the pixels that triangles have painted.
    double filled() const;
    Image take() { return std::move(image_); }

private:
    void paint(const BakedTriangle& triangle, std::size_t pixel, const Vec3& weights);

    Image image_;
    std::vector<float> distance_; // of each pixel from the triangle that has painted it, in pixels
};

} // namespace devseg::plane
