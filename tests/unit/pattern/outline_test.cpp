// Simple outlines and smooth curves.
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/pattern/corners.h"
#include "devseg/pattern/curves.h"
#include "unit/pattern_samples.h"
#include "unit/shapes.h"

namespace devseg::pattern {
namespace {

using samples::Cloth;
using Points = std::vector<Vec2>;

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - t * (b - a)).norm();
}

Points arc(double radius, double from, double to, int count) {
    Points points;
    for (int i = 0; i <= count; ++i) {
        const double angle = from + (to - from) * i / count;
        points.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

TEST(CollapseVertices, RemovesWhatLiesWithinTheToleranceAndNothingElse) {
    const Points circle = arc(100.0, 0.0, 3.0, 300);
    for (const double tolerance : {0.01, 0.1, 1.0}) {
        const std::vector<Index> kept = collapse_vertices({circle}, tolerance);
        EXPECT_EQ(kept.front(), 0);
        EXPECT_EQ(kept.back(), 300);
        for (std::size_t i = 0; i + 1 < kept.size(); ++i)
            for (Index k = kept[i]; k <= kept[i + 1]; ++k)
                EXPECT_LE(distance(circle[k], circle[kept[i]], circle[kept[i + 1]]), tolerance);
        // A chord of sagitta s spans an angle of √(8 s / r).
        const double needed = 3.0 / std::sqrt(8.0 * tolerance / 100.0);
        EXPECT_GE(static_cast<double>(kept.size()), needed);
        EXPECT_LE(static_cast<double>(kept.size()), 2.5 * needed + 2.0);
    }
}

TEST(CollapseVertices, BothSidesMustAllowIt) {
    const Points straight{{0, 0}, {1, 0}, {2, 0}};
    const Points bent{{0, 0}, {1, 1}, {2, 0}};
    EXPECT_EQ(collapse_vertices({straight}, 0.1).size(), 2U);
    EXPECT_EQ(collapse_vertices({straight, bent}, 0.1).size(), 3U);
    EXPECT_EQ(collapse_vertices({straight, bent}, 1.1).size(), 2U);
}

TEST(CollapseVertices, TheCheapestGoFirstAndHandTheirCostOn) {
    // The triangles at the inner points have the areas 0.25, 0.3 and 0.4. Point 1 goes first and
    // hands 0.125 on: point 2 costs 0.35 + 0.125 then, more than point 3, which goes next. Without
    // it, point 2 is too far from what would remain.
    const Points points{{0, 0}, {1, 0.4}, {2, 0.3}, {3, 0.8}, {3.4, 0.2}};
    EXPECT_EQ(collapse_vertices({points}, 0.6), (std::vector<Index>{0, 2, 4}));
}

TEST(CollapseVertices, ClosedPolylinesKeepThreePoints) {
    Points circle = arc(1.0, 0.0, 2.0 * shapes::pi, 30);
    circle.back() = circle.front();
    EXPECT_EQ(collapse_vertices({circle}, 100.0).size(), 4U);
}

TEST(Outlines, SquareKeepsItsCornersAndLosesTheRest) {
    Cloth cloth;
    cloth.add(shapes::grid(20, 20, 100.0, 100.0),
              [](const Vec3& p, const Vec3&) { return samples::flat(p); });
    const PiecePath outer = cloth.pattern().pieces[0].outer;
    ASSERT_EQ(outer.points.size(), 4U);
    for (const std::uint8_t corner : outer.corner)
        EXPECT_EQ(corner, 1);
    PatternOptions options;
    options.simplify_mm = 0.0;
    EXPECT_EQ(cloth.pattern(options).pieces[0].outer.points.size(), 80U);
}

TEST(Outlines, DiskHasNoCorners) {
    Cloth cloth;
    cloth.add(shapes::annulus(120, 4, 20.0, 100.0),
              [](const Vec3& p, const Vec3&) { return samples::flat(p); });
    PatternOptions options;
    options.curve_mm = 0.1;
    const PatternPiece piece = cloth.pattern(options).pieces[0];
    ASSERT_EQ(piece.holes.size(), 1U);
    for (const PiecePath* path : {&piece.outer, &piece.holes[0]}) {
        for (const std::uint8_t corner : path->corner)
            EXPECT_EQ(corner, 0);
        EXPECT_FALSE(path->curves.empty());
        EXPECT_LE(path->curves.size(), 12U);
        for (const OutlineCurve& curve : path->curves)
            EXPECT_FALSE(curve.is_line);
    }
}

TEST(Outlines, CrossingIsExact) {
    PatternPiece piece;
    piece.outer.points = {{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}; // touches its own edge
    EXPECT_FALSE(crosses_itself(piece));
    piece.outer.points[3].y() = -1e-12;
    EXPECT_TRUE(crosses_itself(piece));
    EXPECT_FALSE(crosses_itself(piece, 0.01));
    piece.outer.points[3].y() = -0.02;
    EXPECT_TRUE(crosses_itself(piece, 0.01));
}

Vec2 evaluate(const OutlineCurve& curve, double t) {
    const auto& c = curve.control;
    const double s = 1.0 - t;
    return s * s * s * c[0] + 3.0 * s * s * t * c[1] + 3.0 * s * t * t * c[2] + t * t * t * c[3];
}

TEST(Curves, StayWithinTheToleranceAndSmooth) {
    for (const double tolerance : {0.02, 0.2, 2.0}) {
        const Points points = arc(100.0, 0.3, 5.5, 400);
        const std::vector<OutlineCurve> curves = fit_polyline(points, tolerance);
        EXPECT_LE(curves.size(), tolerance < 0.1 ? 16U : 8U);
        EXPECT_EQ(curves.front().control[0], points.front());
        EXPECT_EQ(curves.back().control[3], points.back());
        Index next = 0;
        for (std::size_t i = 0; i < curves.size(); ++i) {
            const OutlineCurve& curve = curves[i];
            EXPECT_EQ(curve.first, next);
            next += curve.count;
            EXPECT_EQ(curve.control[0], points[curve.first]);
            for (int k = 0; k <= 50; ++k)
                EXPECT_NEAR(evaluate(curve, k / 50.0).norm(), 100.0, tolerance + 0.01);
            if (i == 0)
                continue;
            const Vec2 in = (curves[i - 1].control[3] - curves[i - 1].control[2]).normalized();
            const Vec2 out = (curve.control[1] - curve.control[0]).normalized();
            EXPECT_NEAR(in.dot(out), 1.0, 1e-9);
        }
        EXPECT_EQ(next, 400);
    }
}

TEST(Curves, StraightStretchesAreLines) {
    const Points points{{0, 0}, {1, 0}, {5, 0.001}, {9, 0}};
    const std::vector<OutlineCurve> curves = fit_polyline(points, 0.1);
    ASSERT_EQ(curves.size(), 1U);
    EXPECT_TRUE(curves[0].is_line);
    EXPECT_EQ(fit_polyline(points, 0.0).size(), 3U);
}

TEST(Curves, CoverTheOutlineInOrder) {
    PatternOptions options;
    options.curve_mm = 0.1;
    const Pattern pattern = samples::unfinished().pattern(options);
    for (const PatternPiece& piece : pattern.pieces)
        for (Index l = 0; l < piece.path_count(); ++l) {
            const PiecePath& path = piece.path(l);
            std::size_t next = 0;
            for (const OutlineCurve& curve : path.curves) {
                EXPECT_EQ(at(curve.first), next % path.points.size());
                next += at(curve.count);
                EXPECT_LT((curve.control[0] - path.points[curve.first]).norm(), 1e-9);
                EXPECT_LT((curve.control[3] - path.points[next % path.points.size()]).norm(), 1e-9);
            }
            EXPECT_EQ(next, path.points.size());
        }
}

double length_of(const Points& points, bool closed) {
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
        length += (points[i + 1] - points[i]).norm();
    return closed ? length + (points.front() - points.back()).norm() : length;
}

TEST(Curves, AreAsLongAsTheirEdges) {
    Points points = arc(60.0, 0.2, 4.0, 25); // chords, shorter than the arc by 0.4 mm
    Points curve = flatten_curves(fit_polyline(points, 0.4), 1e-5);
    curve.push_back(points.back());
    EXPECT_NEAR(length_of(curve, false), length_of(points, false), 1e-3);
    EXPECT_LT(fit_polyline(points, 0.4).size(), 10U);
}

TEST(Curves, ARingHasItsCorners) {
    Points ring = arc(50.0, 0.0, shapes::pi, 60); // half a disk
    const std::vector<OutlineCurve> curves = fit_ring(ring, 0.35, 0.1);
    const Points flat = flatten_curves(curves, 1e-4);
    EXPECT_NEAR(length_of(flat, true), length_of(ring, true), 0.01);
    EXPECT_EQ(std::count_if(curves.begin(), curves.end(),
                            [](const OutlineCurve& c) { return c.is_line; }),
              1);
    Index covered = 0;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        covered += curves[i].count;
        EXPECT_EQ(curves[i].control[3], curves[(i + 1) % curves.size()].control[0]);
    }
    EXPECT_EQ(covered, 61);
}

} // namespace
} // namespace devseg::pattern
