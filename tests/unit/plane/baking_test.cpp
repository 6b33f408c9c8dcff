#include "devseg/plane/baking.h"

#include <gtest/gtest.h>

namespace devseg::plane {
namespace {

TEST(Baking, ColoursSpreadToTheNearest) {
    Baking baking(20, 10);
    BakedTriangle triangle;
    triangle.place = {Vec2(2, 2), Vec2(6, 2), Vec2(2, 6)};
    triangle.color = {Vec3(10, 0, 0), Vec3(10, 0, 0), Vec3(10, 0, 0)};
    baking.add(triangle, 0.0);
    triangle.place = {Vec2(16, 2), Vec2(18, 2), Vec2(16, 8)};
    triangle.color.fill(Vec3(0, 20, 0));
    baking.add(triangle, 0.0);
    const double painted = baking.filled();
    EXPECT_NEAR(painted, (8.0 + 6.0) / 200.0, 0.02);
    baking.spread(5.0, {1, 2, 3});
    const Image image = baking.take();
    const auto color = [&](int x, int y) { // y up
        const std::size_t pixel = 3 * at(20 * (9 - y) + x);
        return Color{image.rgb[pixel], image.rgb[pixel + 1], image.rgb[pixel + 2]};
    };
    EXPECT_EQ(color(2, 2), (Color{10, 0, 0}));
    EXPECT_EQ(color(0, 0), (Color{10, 0, 0}));
    EXPECT_EQ(color(8, 2), (Color{10, 0, 0}));
    EXPECT_EQ(color(13, 3), (Color{0, 20, 0}));
    EXPECT_EQ(color(19, 2), (Color{0, 20, 0}));
    EXPECT_EQ(color(10, 9), (Color{1, 2, 3})); // too far from both
}

TEST(Baking, HalvedImagesHaveTheMean) {
    const Image image{2, 2, {0, 0, 0, 100, 0, 0, 0, 40, 0, 0, 0, 8}};
    const Image half = halved(image);
    EXPECT_EQ(half.width, 1);
    EXPECT_EQ(half.rgb, (std::vector<std::uint8_t>{25, 10, 2}));
}

} // namespace
} // namespace devseg::plane
