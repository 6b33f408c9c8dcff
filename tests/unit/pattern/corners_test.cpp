// Where seams end: corners on outlines that follow the edges of a mesh.
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/pattern/corners.h"
#include "unit/shapes.h"

namespace devseg::pattern {
namespace {

using Points = std::vector<Vec2>;

constexpr double degree = shapes::pi / 180.0;
constexpr double corner_angle = 40.0 * degree;

// From point to point in steps of about 1, each point pushed to the left and to the right in turn.
Points ragged(const Points& corners, double height) {
    Points points;
    double sign = 1.0;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
        const Vec2 along = corners[i + 1] - corners[i];
        const int count = static_cast<int>(std::round(along.norm()));
        const Vec2 across = Vec2(-along.y(), along.x()) / along.norm();
        for (int k = 0; k < count; ++k) {
            points.push_back(corners[i] + along * k / count + sign * height * across);
            sign = -sign;
        }
    }
    points.push_back(corners.back());
    return points;
}

TEST(Corners, StaircasesHaveNone) {
    const Points stairs = ragged({{0, 0}, {80, 60}}, 0.5); // every point turns by 90 degrees
    EXPECT_TRUE(find_corners({stairs}, 10.0, corner_angle).empty());
    EXPECT_TRUE(find_corners({stairs, stairs}, 5.0, corner_angle).empty());
}

TEST(Corners, ASquareWithRaggedSidesHasFour) {
    const Points square{{0, 0}, {50, 0}, {50, 50}, {0, 50}, {0, 0}};
    for (const double height : {0.0, 0.3}) {
        Points points = ragged(square, height);
        points.back() = points.front();
        const std::vector<Index> corners = find_corners({points}, 8.0, corner_angle);
        ASSERT_EQ(corners.size(), 4U) << height;
        for (std::size_t i = 0; i < 4; ++i)
            EXPECT_LT((points[corners[i]] - square[i]).norm(), 1.5);
    }
    // An open line has corners between its ends alone.
    Points open = ragged(square, 0.0);
    open.pop_back();
    EXPECT_EQ(find_corners({open}, 8.0, corner_angle), (std::vector<Index>{50, 100, 150}));
}

TEST(Corners, RoundedBendsAreNone) {
    Points bend;
    for (int i = 0; i <= 90; ++i)
        bend.push_back(20.0 * Vec2(std::sin(i * degree), 1.0 - std::cos(i * degree)));
    EXPECT_TRUE(find_corners({bend}, 10.0, corner_angle).empty());
}

TEST(Corners, OneOfTwoSidesSuffices) {
    const Points straight = ragged({{0, 0}, {30, 0}, {60, 0}}, 0.0);
    const Points bent = ragged({{0, 0}, {30, 0}, {30, 30}}, 0.0);
    EXPECT_EQ(find_corners({straight, bent}, 6.0, corner_angle), (std::vector<Index>{30}));
    EXPECT_EQ(find_corners({bent, straight}, 6.0, corner_angle), (std::vector<Index>{30}));
    EXPECT_TRUE(find_corners({straight, straight}, 6.0, corner_angle).empty());
}

TEST(Corners, TheSharperOfTwoNeighboursStays) {
    const Points points = ragged({{0, 0}, {40, 0}, {42, 2}, {42, 40}}, 0.0);
    EXPECT_EQ(find_corners({points}, 6.0, corner_angle).size(), 1U);
}

} // namespace
} // namespace devseg::pattern
