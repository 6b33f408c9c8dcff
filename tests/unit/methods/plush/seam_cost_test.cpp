#include "devseg/methods/plush/seam_cost.h"

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

TEST(Narrowness, IsNoneOfRoundSquareAndPointedPieces) {
    std::vector<Vec2> disk;
    for (int k = 0; k < 90; ++k)
        disk.emplace_back(std::cos(k * pi / 45.0), std::sin(k * pi / 45.0));
    EXPECT_EQ(narrowness(disk, 0.6), 0.0);
    EXPECT_EQ(narrowness(dense({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), 0.6), 0.0);
    EXPECT_EQ(narrowness(dense({{0, 0}, {2, 0}, {1, 1}}), 0.6), 0.0);
}

TEST(Narrowness, CountsNecksOnce) {
    // Two squares with a bridge between them.
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
    const std::vector<Neck> necks = find_necks(dumbbell, 0.6);
    ASSERT_EQ(necks.size(), 1U);
    EXPECT_NEAR(necks[0].lacking, 0.6 - 0.1, 0.03);
    EXPECT_NEAR((dumbbell[necks[0].first] - dumbbell[necks[0].last]).norm(), 0.1, 0.03);
}

TEST(Narrowness, DartsNarrowWhatTheyLeave) {
    const auto with_dart = [](double depth) {
        return dense({{0, 0}, {0.98, 0}, {1, depth}, {1.02, 0}, {2, 0}, {2, 1}, {0, 1}});
    };
    EXPECT_EQ(narrowness(with_dart(0.3), 0.6), 0.0);
    EXPECT_NEAR(narrowness(with_dart(0.8), 0.6), 0.6 - 0.2, 0.03);
}

TEST(Narrowness, TonguesCountByTheirRoots) {
    const std::vector<Vec2> tongue =
        dense({{0, 0}, {1, 0}, {1, 0.45}, {1.6, 0.45}, {1.6, 0.55}, {1, 0.55}, {1, 1}, {0, 1}});
    EXPECT_NEAR(narrowness(tongue, 0.6), 0.6 * std::sqrt(0.06) - 0.1, 0.02);
}

} // namespace
} // namespace devseg::plush
