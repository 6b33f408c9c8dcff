#include "devseg/pack/pack.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include <gtest/gtest.h>

#include "devseg/base/parallel.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::pack {
namespace {

using checks::common_area;
using shapes::pi;
using shapes::Random;

struct Shape {
    std::vector<Triangle> faces;
    std::vector<Vec2> points;
};

Shape rectangle(double width, double height) {
    return {{{0, 1, 2}, {0, 2, 3}}, {{0, 0}, {width, 0}, {width, height}, {0, height}}};
}

// A ring of the given half-width around a centre far from the origin.
Shape ring(double inner, double outer, Index around) {
    Shape shape;
    for (Index i = 0; i < around; ++i)
        for (const double r : {outer, inner}) {
            const double t = 2.0 * pi * i / around;
            shape.points.emplace_back(7.0 + r * std::cos(t), -3.0 + r * std::sin(t));
        }
    for (Index i = 0; i < around; ++i) {
        const Index a = 2 * i;
        const Index b = 2 * ((i + 1) % around);
        shape.faces.push_back({a, b, b + 1});
        shape.faces.push_back({a, b + 1, a + 1});
    }
    return shape;
}

// A fan around its first point with random radii: star-shaped, with bays.
Shape star(Random& random, double size) {
    Shape shape;
    const Index corners = 5 + random.below(6);
    shape.points.push_back(Vec2(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0)));
    for (Index i = 0; i < corners; ++i) {
        const double t = 2.0 * pi * i / corners;
        shape.points.push_back(shape.points[0] +
                               size * random.uniform(0.3, 1.0) * Vec2(std::cos(t), std::sin(t)));
        shape.faces.push_back({0, 1 + i, 1 + (i + 1) % corners});
    }
    return shape;
}

std::vector<Shape> stars(int count, std::uint32_t seed) {
    Random random(seed);
    std::vector<Shape> shapes;
    for (int i = 0; i < count; ++i)
        shapes.push_back(star(random, random.uniform(0.2, 1.5)));
    return shapes;
}

PackResult pack(const std::vector<Shape>& shapes, const PackOptions& options) {
    std::vector<PackItem> items;
    for (const Shape& shape : shapes)
        items.push_back({&shape.faces, &shape.points});
    Progress progress;
    return pack_charts(items, options, progress);
}

Shape placed(const Shape& shape, const Placement& placement) {
    Shape result = shape;
    for (Vec2& p : result.points)
        p = placement(p);
    return result;
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 edge = b - a;
    const double t = std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    return (p - a - t * edge).norm();
}

// Of two charts that do not overlap: between edges of one and vertices of the other.
double gap(const Shape& a, const Shape& b) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [s, other] : {std::pair(&a, &b), {&b, &a}})
        for (const Triangle& t : s->faces)
            for (std::size_t k = 0; k < 3; ++k)
                for (const Vec2& p : other->points)
                    least = std::min(
                        least, distance_to_segment(p, s->points[t[k]], s->points[t[(k + 1) % 3]]));
    return least;
}

double shared_area(const Shape& a, const Shape& b) {
    double sum = 0.0;
    for (const Triangle& s : a.faces)
        for (const Triangle& t : b.faces)
            sum += common_area({a.points[s[0]], a.points[s[1]], a.points[s[2]]},
                               {b.points[t[0]], b.points[t[1]], b.points[t[2]]});
    return sum;
}

double area(const Shape& shape) {
    double sum = 0.0;
    for (const Triangle& t : shape.faces) {
        const Vec2 p = shape.points[t[1]] - shape.points[t[0]];
        const Vec2 q = shape.points[t[2]] - shape.points[t[0]];
        sum += 0.5 * (p.x() * q.y() - p.y() * q.x());
    }
    return sum;
}

double total_area(const std::vector<Shape>& shapes) {
    double sum = 0.0;
    for (const Shape& shape : shapes)
        sum += area(shape);
    return sum;
}

// Packs, and checks what pack.h promises of every result.
PackResult expect_promises(const std::vector<Shape>& shapes, const PackOptions& options) {
    const PackResult r = pack(shapes, options);
    EXPECT_EQ(r.placements.size(), shapes.size());
    std::vector<Shape> laid;
    std::vector<Eigen::AlignedBox2d> boxes(shapes.size());
    const double rounding = 1e-9 * r.side;
    const double distance = options.padding * r.side - rounding;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Placement& p = r.placements[i];
        EXPECT_NEAR(p.cosine * p.cosine + p.sine * p.sine, 1.0, 1e-12); // rigid, no mirror image
        EXPECT_TRUE(options.allow_rotation || (p.cosine == 1.0 && p.sine == 0.0));
        laid.push_back(placed(shapes[i], p));
        EXPECT_NEAR(area(laid[i]), area(shapes[i]), 1e-9 * area(shapes[i]));
        for (const Vec2& point : laid[i].points) {
            EXPECT_GE(point.minCoeff(), 0.5 * options.padding * r.side - rounding);
            EXPECT_LE(point.maxCoeff(), (1.0 - 0.5 * options.padding) * r.side + rounding);
            boxes[i].extend(point);
        }
    }
    for (std::size_t i = 0; i < laid.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            if (boxes[i].exteriorDistance(boxes[j]) > distance + rounding)
                continue;
            EXPECT_LT(shared_area(laid[i], laid[j]), 1e-12 * r.side * r.side);
            EXPECT_GE(gap(laid[i], laid[j]), distance);
        }
    return r;
}

// Nesting takes its fixed effort for every layout: the cases are few.
TEST(Pack, KeepsItsPromisesOnRandomStars) {
    expect_promises(stars(6, 1), PackOptions{0.0, true});
    expect_promises(stars(9, 2), PackOptions{0.1, false});
    expect_promises(stars(3, 3), PackOptions{0.02, true});
}

TEST(Pack, RandomStarsUseMostOfTheSquare) {
    const std::vector<Shape> shapes = stars(30, 101);
    const double sum = total_area(shapes);
    const PackResult r = expect_promises(shapes, PackOptions{0.002, true});
    EXPECT_GT(sum / (r.side * r.side), 0.6);
}

Shape triangle(const Vec2& a, const Vec2& b, const Vec2& c) {
    Shape shape;
    shape.faces = {{0, 1, 2}};
    shape.points = {a, b, c};
    return shape;
}

std::vector<Shape> triangles(Index count, std::uint32_t seed) {
    Random random(seed);
    std::vector<Shape> shapes;
    while (static_cast<Index>(shapes.size()) < count)
        shapes.push_back(triangle({0, 0}, {random.uniform(0.5, 1.0), random.uniform(-0.2, 0.2)},
                                  {random.uniform(0.0, 0.6), random.uniform(0.4, 1.0)}));
    return shapes;
}

PackResult expect_same_bytes_on_one_thread(const std::vector<Shape>& shapes) {
    PackResult a = pack(shapes, PackOptions{});
    set_thread_limit(1);
    const PackResult b = pack(shapes, PackOptions{});
    set_thread_limit(0);
    EXPECT_EQ(a.side, b.side);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        EXPECT_EQ(a.placements[i].offset, b.placements[i].offset);
        EXPECT_EQ(a.placements[i].cosine, b.placements[i].cosine);
        EXPECT_EQ(a.placements[i].sine, b.placements[i].sine);
    }
    return a;
}

TEST(Pack, ManyTrianglesAreFittedTogether) {
    for (const Index count : {400, 1500}) {
        const std::vector<Shape> shapes = triangles(count, 9);
        const double sum = total_area(shapes);
        const PackResult r = expect_promises(shapes, PackOptions{0.001, true});
        EXPECT_GT(sum / (r.side * r.side), 0.6) << count;
    }
}

// The room that the padding takes was taken for a bad layout, and searched for minutes.
TEST(Pack, PaddingOfManyChartsTakesNoMoreTime) {
    Random random(7);
    std::vector<Shape> shapes;
    for (int i = 0; i < 300; ++i)
        shapes.push_back(rectangle(random.uniform(0.5, 1.0), random.uniform(0.5, 1.0)));
    const auto work = [&](double padding) {
        const std::clock_t start = std::clock();
        pack(shapes, PackOptions{padding, true});
        return static_cast<double>(std::clock() - start);
    };
    const double without = work(0.0);
    EXPECT_LT(work(0.015), 6.0 * without);
}

TEST(Pack, ThreadsDoNotMatterToManyCharts) {
    expect_same_bytes_on_one_thread(triangles(300, 4));
}

TEST(Pack, TenThousandChartsLieOnShelves) {
    Random random(6);
    std::vector<Shape> shapes;
    for (int i = 0; i < 10001; ++i)
        shapes.push_back(rectangle(random.uniform(0.5, 1.0), random.uniform(0.5, 1.0)));
    const double sum = total_area(shapes);
    const PackResult r = expect_promises(shapes, PackOptions{0.0005, true});
    EXPECT_GT(sum / (r.side * r.side), 0.6);
}

TEST(Pack, VeryManyChartsAreLaidOutAsWell) {
    Random random(6);
    std::vector<Shape> shapes;
    for (int i = 0; i < 1100; ++i)
        shapes.push_back(rectangle(random.uniform(0.1, 1.0), random.uniform(0.1, 1.0)));
    const double sum = total_area(shapes);
    for (const bool allow_rotation : {true, false}) {
        const PackResult r = expect_promises(shapes, PackOptions{0.001, allow_rotation});
        EXPECT_GT(sum / (r.side * r.side), 0.5);
    }
}

TEST(Pack, EveryEffortKeepsThePromisesAndMoreOfItIsDenser) {
    double sum_of_fast = 0.0;
    double sum_of_normal = 0.0;
    double sum_of_best = 0.0;
    for (const int count : {3, 8, 12}) {
        const std::vector<Shape> shapes = stars(count, 5);
        const auto side = [&](PackEffort effort) {
            return expect_promises(shapes, PackOptions{0.004, true, effort}).side;
        };
        const double best = side(PackEffort::best);
        sum_of_best += 1.0;
        sum_of_normal += side(PackEffort::normal) / best;
        sum_of_fast += side(PackEffort::fast) / best;
    }
    EXPECT_GT(sum_of_fast, 1.02 * sum_of_best);
    EXPECT_LT(sum_of_normal, 0.99 * sum_of_fast);
    EXPECT_LT(sum_of_normal, 1.02 * sum_of_best);
}

TEST(Pack, TheLeastEffortTakesMilliseconds) {
    const std::vector<Shape> shapes = stars(12, 5);
    const auto time = [&](PackEffort effort) {
        const std::clock_t start = std::clock(); // of the processor: the machine may be busy
        pack(shapes, PackOptions{0.002, true, effort});
        return static_cast<double>(std::clock() - start);
    };
    EXPECT_LT(5.0 * time(PackEffort::fast), time(PackEffort::normal));
}

TEST(Pack, ATurnedRectangleIsPutUpright) {
    Shape shape = rectangle(3.0, 3.0);
    const Eigen::Rotation2Dd turn(0.6);
    for (Vec2& p : shape.points)
        p = turn * p;
    EXPECT_NEAR(pack({shape}, PackOptions{0.0, true}).side, 3.0, 1e-9);
    EXPECT_NEAR(pack({shape}, PackOptions{0.0, false}).side, 3.0 * (std::cos(0.6) + std::sin(0.6)),
                1e-9);
}

TEST(Pack, OneChartFillsTheSquareUpToThePadding) {
    for (const double padding : {0.0, 0.05, 0.1}) {
        const PackResult r = pack({rectangle(4.0, 1.0)}, PackOptions{padding, true});
        EXPECT_NEAR(r.side * (1.0 - padding), 4.0, 1e-9);
    }
}

TEST(Pack, EqualSquaresArePackedTightly) {
    const PackResult r = pack(std::vector<Shape>(9, rectangle(1.0, 1.0)), PackOptions{0.0, true});
    EXPECT_GE(r.side, 3.0 - 1e-9);
    EXPECT_LE(r.side, 1.04 * 3.0);
}

TEST(Pack, AHoleIsUsedBySmallerCharts) {
    const std::vector<Shape> shapes = {rectangle(2.0, 2.0), ring(3.0, 4.0, 48),
                                       rectangle(3.0, 0.9)};
    const PackOptions options{0.005, true};
    const PackResult r = expect_promises(shapes, options);
    const Vec2 centre = r.placements[1](Vec2(7.0, -3.0));
    for (const std::size_t i : {0U, 2U})
        for (const Vec2& p : placed(shapes[i], r.placements[i]).points)
            EXPECT_LT((p - centre).norm(), 3.0);
    EXPECT_NEAR(r.side * (1.0 - options.padding), 8.0, 0.05); // no larger than the ring alone
}

TEST(Pack, NeitherThreadsNorUnitsMatter) {
    const std::vector<Shape> shapes = stars(7, 8);
    const PackResult a = expect_same_bytes_on_one_thread(shapes);
    std::vector<Shape> scaled = shapes;
    const double scale = std::ldexp(1.0, -30); // changes no digit
    for (Shape& shape : scaled)
        for (Vec2& p : shape.points)
            p *= scale;
    const PackResult c = pack(scaled, PackOptions{});
    EXPECT_NEAR(a.side, c.side / scale, 1e-9 * a.side);
    for (std::size_t i = 0; i < shapes.size(); ++i)
        EXPECT_NEAR(a.placements[i].cosine, c.placements[i].cosine, 1e-9);
}

// Ribbons: their length is many times the side of a square of their area.
TEST(Pack, ThinChartsTakeNoMoreTimeAndMemoryThanOthers) {
    for (const double ratio : {1e2, 1e3, 1e4, 1e6}) {
        const std::vector<Shape> shapes = {rectangle(1.0, 1.0 / ratio),
                                           rectangle(0.3, 0.1 / ratio)};
        const std::clock_t start = std::clock(); // of the processor: the machine may be busy
        expect_promises(shapes, PackOptions{});
        ASSERT_LT(std::clock() - start, 4 * CLOCKS_PER_SEC) << ratio;
    }
}

TEST(Pack, RowsAreAsChartsStandAndFillMostOfASquare) {
    Random random(11);
    std::vector<Shape> shapes;
    for (int i = 0; i < 300; ++i)
        shapes.push_back(rectangle(random.uniform(0.5, 2.0), random.uniform(0.5, 3.0)));
    std::vector<PackItem> items;
    double area = 0.0;
    for (const Shape& shape : shapes) {
        items.push_back({&shape.faces, &shape.points});
        area += shape.points[2].prod();
    }
    const PackResult rows = pack_rows(items, 0.01);
    EXPECT_GT(area, 0.75 * rows.side * rows.side);
    std::vector<Eigen::AlignedBox2d> boxes;
    for (std::size_t i = 0; i < items.size(); ++i) {
        EXPECT_EQ(rows.placements[i].cosine, 1.0);
        boxes.push_back(plane::box_of(shapes[i].points, rows.placements[i]));
        EXPECT_GT(boxes[i].min().minCoeff(), 0.0);
        EXPECT_LT(boxes[i].max().maxCoeff(), rows.side);
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_GE(boxes[i].exteriorDistance(boxes[j]), 0.01 * 2.5);
    }
    EXPECT_EQ(pack_rows({}, 0.01).side, 0.0);
}

TEST(Pack, NothingNeedsNoRoom) {
    EXPECT_TRUE(pack({}, PackOptions{}).placements.empty());
}

TEST(Pack, PaddingOutOfRangeIsRefused) {
    for (const double padding : {-0.001, 0.11, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_TRUE(checks::contains(checks::error_of<InvalidParameter>([&] {
                                         pack({rectangle(1.0, 1.0)}, PackOptions{padding, true});
                                     }),
                                     "from 0 to 0.1"));
}

TEST(Pack, Cancels) {
    for (const std::vector<Shape>& shapes : {stars(12, 2), triangles(900, 2)}) {
        std::vector<PackItem> items;
        for (const Shape& shape : shapes)
            items.push_back({&shape.faces, &shape.points});
        for (const int stop : {1, 3}) {
            int calls = 0;
            Progress progress([&](double, const char*) { return ++calls < stop; });
            EXPECT_THROW(pack_charts(items, PackOptions{}, progress), Cancelled);
            EXPECT_EQ(calls, stop);
        }
    }
}

} // namespace
} // namespace devseg::pack
