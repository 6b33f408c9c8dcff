#include "devseg/plane/box_grid.h"

#include <random>

#include <gtest/gtest.h>

namespace devseg::plane {
namespace {

// Boxes of all sizes, some of them points, some far away from the others.
std::vector<Eigen::AlignedBox2d> random_boxes(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0.0, 1.0);
    std::vector<Eigen::AlignedBox2d> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        const double size = i % 5 == 0 ? 0.0 : i % 7 == 0 ? 0.6 : 0.05;
        const Vec2 low(place(random) + (i % 50 == 0 ? 9.0 : 0.0), place(random));
        boxes.emplace_back(low, Vec2(low + size * Vec2(place(random), place(random))));
    }
    return boxes;
}

TEST(BoxGrid, FindsThoseThatTouchAndNoOthers) {
    const std::vector<Eigen::AlignedBox2d> boxes = random_boxes(300);
    BoxGrid grid(boxes);
    for (Index i = 0; i < 300; i += 2)
        grid.add(i);
    int pairs = 0;
    for (const Eigen::AlignedBox2d& box : boxes)
        for (Index i = 0; i < 300; ++i) {
            const bool touches = i % 2 == 0 && !boxes[at(i)].intersection(box).isEmpty();
            EXPECT_EQ(grid.any_touching(box, [&](Index b) { return b == i; }), touches);
            pairs += touches ? 1 : 0;
        }
    EXPECT_GT(pairs, 500);
}

TEST(BoxGrid, BoxesInOnePlace) {
    const std::vector<Eigen::AlignedBox2d> boxes(3, {Vec2(1.0, 1.0), Vec2(1.0, 1.0)});
    BoxGrid grid(boxes);
    EXPECT_FALSE(grid.any_touching(boxes[0], [](Index) { return true; }));
    grid.add(2);
    EXPECT_TRUE(grid.any_touching(boxes[0], [](Index b) { return b == 2; }));
}

} // namespace
} // namespace devseg::plane
