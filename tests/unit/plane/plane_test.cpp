#include "devseg/plane/plane.h"

#include <gtest/gtest.h>

#include "unit/mesh_edits.h"

namespace devseg::plane {
namespace {

using shapes::Random;

const std::vector<Vec2> corner{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}; // an L
constexpr double exact = 1e-15;

Vec2 anywhere(Random& random) {
    return {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
}

TEST(Plane, MeasuresPolygons) {
    EXPECT_DOUBLE_EQ(signed_area(corner), 6.0);
    EXPECT_DOUBLE_EQ(signed_area({corner.rbegin(), corner.rend()}), -6.0);
    EXPECT_DOUBLE_EQ(perimeter(corner), 14.0);
    EXPECT_DOUBLE_EQ(triangle_area({0, 0}, {0, 2}, {3, 0}), 3.0);
    EXPECT_EQ(box_of(corner).sizes(), Vec2(4, 3));
    EXPECT_TRUE(box_of({}).isEmpty());
}

TEST(Plane, FindsWhatLiesInsideOfPolygons) {
    EXPECT_TRUE(is_inside(corner, Vec2(0.5, 2.5)));
    EXPECT_FALSE(is_inside(corner, Vec2(2.0, 2.0)));
    EXPECT_FALSE(is_inside(corner, Vec2(-1.0, 1.0))); // as high as two of its edges
    const std::vector<Vec2> hole{{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}};
    EXPECT_TRUE(is_inside({corner, hole}, Vec2(0.3, 0.7)));
    EXPECT_FALSE(is_inside({corner, hole}, Vec2(0.7, 0.3)));
}

TEST(Plane, MeasuresAngles) {
    EXPECT_NEAR(signed_angle({1, 0}, {0, 2}), 0.5 * pi, exact);
    EXPECT_NEAR(signed_angle({0, 2}, {1, 0}), -0.5 * pi, exact);
    EXPECT_NEAR(angle_between({0, 2}, {1, 0}), 0.5 * pi, exact);
    EXPECT_NEAR(turn({0, 0}, {1, 0}, {2, 1}), 0.25 * pi, exact);
    EXPECT_EQ(left_of({1, 0}), Vec2(0, 1));
    EXPECT_EQ(turned({1, 2}, 0.0, 1.0), Vec2(-2, 1));
}

TEST(Plane, MeasuresDistancesFromSegments) {
    EXPECT_DOUBLE_EQ(distance({1, 2}, {0, 0}, {4, 0}), 2.0);
    EXPECT_DOUBLE_EQ(distance({7, 4}, {0, 0}, {4, 0}), 5.0);
    EXPECT_DOUBLE_EQ(distance({3, 4}, {0, 0}, {0, 0}), 5.0); // a point
    Random random(5);
    for (int run = 0; run < 1000; ++run) {
        const Vec2 p = anywhere(random);
        const Vec2 a = anywhere(random);
        const Vec2 b = anywhere(random);
        ASSERT_NEAR(distance(p, a, b), (p - nearest_point(p, a, b)).norm(), exact);
        for (const double share : {0.0, 0.3, 0.7, 1.0}) // no other point is nearer
            ASSERT_LE(distance(p, a, b), (p - a - share * (b - a)).norm() + exact);
    }
}

TEST(Plane, SegmentsCrossInsideAndTouchAtTheirEnds) {
    EXPECT_TRUE(segments_cross({0, 0}, {2, 2}, {0, 2}, {2, 0}));
    EXPECT_FALSE(segments_cross({0, 0}, {2, 2}, {1, 1}, {2, 0})); // an end lies on the other
    EXPECT_TRUE(segments_touch({0, 0}, {2, 2}, {1, 1}, {2, 0}));
    EXPECT_FALSE(segments_touch({0, 0}, {2, 2}, {1.5, 1}, {2, 0}));
    EXPECT_FALSE(segments_cross({0, 0}, {2, 0}, {1, 0}, {3, 0})); // on one line
    EXPECT_TRUE(segments_touch({0, 0}, {2, 0}, {1, 0}, {3, 0}));
    EXPECT_FALSE(segments_touch({0, 0}, {2, 0}, {2.5, 0}, {3, 0}));
    Random random(6);
    int crossings = 0;
    for (int run = 0; run < 1000; ++run) {
        const Vec2 a = anywhere(random);
        const Vec2 b = anywhere(random);
        const Vec2 c = anywhere(random);
        const Vec2 d = anywhere(random);
        const bool crossing = segments_cross(a, b, c, d);
        ASSERT_EQ(crossing, segments_cross(d, c, a, b));
        ASSERT_EQ(crossing, segments_touch(a, b, c, d)); // ends lie on no other segment
        crossings += crossing ? 1 : 0;
    }
    EXPECT_GT(crossings, 100);
}

} // namespace
} // namespace devseg::plane
