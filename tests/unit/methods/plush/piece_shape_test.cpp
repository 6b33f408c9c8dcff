#include "devseg/methods/plush/piece_shape.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace devseg::plush {
namespace {

// A closed polygon with corners every `step`.
std::vector<Vec2> dense(const std::vector<Vec2>& corners, double step = 0.02) {
    std::vector<Vec2> outline;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec2& a = corners[i];
        const Vec2& b = corners[(i + 1) % corners.size()];
        const int count = std::max(1, static_cast<int>(std::ceil((b - a).norm() / step)));
        for (int k = 0; k < count; ++k)
            outline.push_back(a + static_cast<double>(k) / count * (b - a));
    }
    return outline;
}

double narrowest(const std::vector<Vec2>& outline) {
    return narrowest_neck(outline, 1.0).width;
}

TEST(Necks, RoundSquareAndPointedPiecesHaveNone) {
    std::vector<Vec2> disk;
    for (int k = 0; k < 90; ++k)
        disk.emplace_back(std::cos(k * pi / 45.0), std::sin(k * pi / 45.0));
    EXPECT_EQ(narrowest(disk), 1.0);
    EXPECT_EQ(narrowest(dense({{0, 0}, {1, 0}, {1, 1}, {0, 1}})), 1.0);
    EXPECT_EQ(narrowest(dense({{0, 0}, {2, 0}, {1, 1}})), 1.0);
}

TEST(Necks, OfTwoSquaresIsTheBridgeBetweenThem) {
    const std::vector<Vec2> dumbbell = dense({{0, 0},
                                              {1, 0},
                                              {1, 0.45},
                                              {1.3, 0.45},
                                              {1.3, 0},
                                              {2.3, 0},
                                              {2.3, 1},
                                              {1.3, 1},
                                              {1.3, 0.55},
                                              {1, 0.55},
                                              {1, 1},
                                              {0, 1}});
    const Neck neck = narrowest_neck(dumbbell, 0.6);
    EXPECT_NEAR(neck.width, 0.1, 0.02);
    EXPECT_NEAR((dumbbell[neck.first] - dumbbell[neck.last]).norm(), 0.1, 0.03);
}

TEST(Necks, DartsNarrowWhatTheyLeave) {
    const auto with_dart = [](double depth) {
        return dense({{0, 0}, {0.98, 0}, {1, depth}, {1.02, 0}, {2, 0}, {2, 1}, {0, 1}});
    };
    EXPECT_NEAR(narrowest(with_dart(0.3)), 0.7, 0.05);
    EXPECT_NEAR(narrowest(with_dart(0.8)), 0.2, 0.05);
}

TEST(Necks, TonguesCountByTheirRoots) {
    const std::vector<Vec2> tongue =
        dense({{0, 0}, {1, 0}, {1, 0.45}, {1.6, 0.45}, {1.6, 0.55}, {1, 0.55}, {1, 1}, {0, 1}});
    EXPECT_NEAR(narrowest(tongue), 0.1 / std::sqrt(0.06), 0.05);
}

} // namespace
} // namespace devseg::plush
