#include "devseg/flatten/energy/map_tools.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;
using shapes::Random;

__extension__ using Wide = __int128;

// A point on the lattice of the given step; whole numbers below 2^60.
struct LatticePoint {
    std::int64_t x;
    std::int64_t y;
    Vec2 scaled(int exponent) const {
        return Vec2(std::ldexp(static_cast<double>(x), exponent),
                    std::ldexp(static_cast<double>(y), exponent));
    }
};

int exact_sign(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
    const Wide determinant =
        static_cast<Wide>(b.x - a.x) * (c.y - a.y) - static_cast<Wide>(b.y - a.y) * (c.x - a.x);
    return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
}

int sign(double x) {
    return x > 0.0 ? 1 : x < 0.0 ? -1 : 0;
}

TEST(Orientation, IsExactAroundALine) {
    // Points within 256 steps of 2^-53 from (½, ½), and two points of the diagonal far away.
    constexpr std::int64_t unit = std::int64_t{1} << 53;
    const LatticePoint b{12 * unit, 12 * unit};
    const LatticePoint c{24 * unit, 24 * unit};
    Index zeros = 0;
    Index wrong_in_doubles = 0;
    for (std::int64_t i = 0; i < 256; ++i)
        for (std::int64_t j = 0; j < 256; ++j) {
            const LatticePoint a{unit / 2 + i, unit / 2 + j};
            const int expected = exact_sign(a, b, c);
            const Vec2 p = a.scaled(-53);
            const Vec2 q = b.scaled(-53);
            const Vec2 r = c.scaled(-53);
            ASSERT_EQ(sign(orientation(p, q, r)), expected);
            ASSERT_EQ(sign(orientation(q, r, p)), expected);
            ASSERT_EQ(sign(orientation(r, q, p)), -expected);
            zeros += expected == 0 ? 1 : 0;
            const Vec2 d = q - p;
            const Vec2 e = r - p;
            wrong_in_doubles += sign(d.x() * e.y() - d.y() * e.x()) != expected ? 1 : 0;
        }
    EXPECT_EQ(zeros, 256);
    EXPECT_GT(wrong_in_doubles, 100); // otherwise this test would show nothing
}

TEST(Orientation, IsExactOnRandomPointsNearALine) {
    Random random(31);
    const auto coordinate = [&] {
        return static_cast<std::int64_t>(random.uniform(-1.0, 1.0) * 4503599627370496.0); // 2^52
    };
    int signs[3] = {0, 0, 0};
    for (int run = 0; run < 20000; ++run) {
        const LatticePoint a{coordinate(), coordinate()};
        const LatticePoint b{coordinate(), coordinate()};
        const double t = random.uniform(-0.5, 1.5);
        const LatticePoint c{
            a.x + static_cast<std::int64_t>(t * static_cast<double>(b.x - a.x)) / 2 +
                random.below(3) - 1,
            a.y + static_cast<std::int64_t>(t * static_cast<double>(b.y - a.y)) / 2 +
                random.below(3) - 1};
        const int expected = exact_sign(a, b, c);
        ++signs[expected + 1];
        const int exponent = random.below(200) - 150; // products stay far from under- and overflow
        ASSERT_EQ(sign(orientation(a.scaled(exponent), b.scaled(exponent), c.scaled(exponent))),
                  expected);
    }
    EXPECT_GT(signs[0], 1000);
    EXPECT_GT(signs[2], 1000);
}

TEST(Orientation, IsExactForPointsOfVeryDifferentSize) {
    Random random(32);
    for (int run = 0; run < 5000; ++run) {
        const auto whole = [&](int bits) {
            return static_cast<std::int64_t>(random.uniform(-1.0, 1.0) * std::ldexp(1.0, bits));
        };
        const LatticePoint a{whole(6), whole(6)};
        const LatticePoint b{whole(30), whole(30)};
        const LatticePoint c{a.x + 3 * (b.x - a.x) + whole(2), a.y + 3 * (b.y - a.y) + whole(2)};
        ASSERT_EQ(sign(orientation(a.scaled(-40), b.scaled(-40), c.scaled(-40))),
                  exact_sign(a, b, c));
    }
}

TEST(Orientation, IsTwiceTheArea) {
    EXPECT_DOUBLE_EQ(orientation({0, 0}, {3, 0}, {0, 2}), 6.0);
    EXPECT_DOUBLE_EQ(orientation({1, 1}, {1, 3}, {4, 1}), -6.0);
    EXPECT_EQ(orientation({0.1, 0.1}, {0.1, 0.1}, {7.0, 3.0}), 0.0);
}

TEST(CountFlips, CountsTurnedAndCollapsedFaces) {
    const Disk disk(shapes::grid(3, 3));
    std::vector<Vec2> uv;
    for (const Index v : disk.surface.vertex)
        uv.push_back(disk.mesh.points[v].head<2>());
    EXPECT_EQ(count_flips(disk.problem, uv), 0);
    std::vector<Vec2> mirrored = uv;
    for (Vec2& p : mirrored)
        p.x() = -p.x();
    EXPECT_EQ(count_flips(disk.problem, mirrored), disk.mesh.face_count());
    for (Vec2& p : mirrored)
        p.x() = 0.0;
    EXPECT_EQ(count_flips(disk.problem, mirrored), disk.mesh.face_count());
    uv.at(0) = uv.at(5); // the corner of two faces moves onto the opposite one
    EXPECT_EQ(count_flips(disk.problem, uv), checks::count_flips(disk.problem.faces, uv));
    EXPECT_GT(count_flips(disk.problem, uv), 0);
}

TEST(MapTools, JacobianOfAnAffineMapIsTheMap) {
    const Disk disk(shapes::with_noise(shapes::grid(4, 3), 0.0, 1));
    Eigen::Matrix2d map;
    map << 1.5, -0.7, 0.2, 0.9;
    std::vector<Vec2> uv;
    for (const Index v : disk.surface.vertex)
        uv.push_back(map * disk.mesh.points[v].head<2>() + Vec2(3.0, 4.0));
    for (std::size_t f = 0; f < disk.problem.faces.size(); ++f) {
        // The rest triangle is turned to lie with its first edge along x.
        const Eigen::Matrix2d j = jacobian(disk.problem, uv, f);
        EXPECT_NEAR(j.determinant(), map.determinant(), 1e-12);
        EXPECT_NEAR(j.squaredNorm(), map.squaredNorm(), 1e-12);
    }
    EXPECT_NEAR(map_area(disk.problem, uv), map.determinant() * disk.problem.total_area, 1e-12);
}

TEST(MapTools, ScaleToAreaKeepsTheShape) {
    const Disk disk(shapes::hemisphere(12, 5));
    Random random(33);
    std::vector<Vec2> uv;
    for (const Index v : disk.surface.vertex) {
        const Vec3& p = disk.mesh.points[v];
        uv.emplace_back(7.0 * p.x() + 100.0, 3.0 * p.y() - 50.0);
    }
    std::vector<Vec2> scaled = uv;
    scale_to_area(disk.problem, scaled);
    EXPECT_NEAR(map_area(disk.problem, scaled), disk.problem.total_area, 1e-10);
    Vec2 centre = Vec2::Zero();
    for (const Vec2& p : scaled)
        centre += p / static_cast<double>(scaled.size());
    EXPECT_LT(centre.norm(), 1e-10);
    const double scale = (scaled[1] - scaled[0]).norm() / (uv[1] - uv[0]).norm();
    for (std::size_t v = 1; v < uv.size(); ++v)
        EXPECT_LT(((scaled[v] - scaled[0]) - scale * (uv[v] - uv[0])).norm(), 1e-10);
}

TEST(RestShape, TrianglesKeepTheirLengthsAndCotangents) {
    const Disk disk(shapes::with_noise(shapes::cylinder_tube(9, 4), 0.2, 6));
    const Mesh& mesh = disk.mesh;
    double area = 0.0;
    for (std::size_t f = 0; f < disk.problem.faces.size(); ++f) {
        const Triangle& t = mesh.faces[disk.surface.face[f]];
        const auto point = [&](std::size_t k) { return mesh.points[t[k % 3]]; };
        const Eigen::Matrix2d& edges = disk.problem.edges[f];
        EXPECT_NEAR(edges.col(0).norm(), (point(1) - point(0)).norm(), 1e-12);
        EXPECT_NEAR(edges.col(1).norm(), (point(2) - point(0)).norm(), 1e-12);
        EXPECT_NEAR((edges.col(1) - edges.col(0)).norm(), (point(2) - point(1)).norm(), 1e-12);
        EXPECT_GT(edges.determinant(), 0.0);
        EXPECT_NEAR((edges * disk.problem.inverse[f] - Eigen::Matrix2d::Identity()).norm(), 0.0,
                    1e-10);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 a = point(k) - point(k + 2);
            const Vec3 b = point(k + 1) - point(k + 2);
            EXPECT_NEAR(disk.problem.cotangent[f][k], a.dot(b) / a.cross(b).norm(), 1e-9);
        }
        area += disk.problem.area[f];
    }
    EXPECT_NEAR(area, mesh.total_area, 1e-12);
    EXPECT_NEAR(disk.problem.total_area, area, 1e-12);
}

TEST(RestShape, TheBoundaryRunsCounterclockwiseOnceAround) {
    const Disk disk(shapes::grid(4, 3));
    double twice = 0.0;
    double length = 0.0;
    const std::vector<Index>& boundary = disk.problem.boundary;
    ASSERT_EQ(boundary.size(), 14U);
    for (std::size_t i = 0; i < boundary.size(); ++i) {
        const auto at_index = [&](std::size_t k) {
            return Vec2(disk.mesh.points[disk.surface.vertex[boundary[k]]].head<2>());
        };
        const Vec2 p = at_index(i);
        const Vec2 q = at_index((i + 1) % boundary.size());
        twice += p.x() * q.y() - p.y() * q.x();
        EXPECT_NEAR(disk.problem.boundary_edge[i], (q - p).norm(), 1e-12);
        length += disk.problem.boundary_edge[i];
    }
    EXPECT_NEAR(0.5 * twice, disk.mesh.total_area, 1e-12);
    EXPECT_NEAR(length * disk.mesh.unit_length, 4.0, 1e-12);
}

TEST(RestShape, FacesWithoutAreaStayFinite) {
    mesh::RawMesh raw = shapes::grid(4, 4);
    raw.points[6] = raw.points[7];                            // two corners coincide
    raw.points[11] = 0.5 * (raw.points[10] + raw.points[12]); // already so: on a line
    raw.points[16] = raw.points[17] = raw.points[18];         // three do
    const Disk disk(raw);
    for (std::size_t f = 0; f < disk.problem.faces.size(); ++f) {
        EXPECT_GT(disk.problem.area[f], 0.0);
        EXPECT_TRUE(disk.problem.inverse[f].allFinite());
        for (const double cotangent : disk.problem.cotangent[f])
            EXPECT_TRUE(std::isfinite(cotangent));
    }
}

TEST(RestShape, ChartsThatAreNoDisksAreRefused) {
    const Mesh mesh = checks::gated(shapes::cylinder_tube(8, 2));
    const atlas::ChartSurface tube = atlas::extract_charts(mesh, checks::components(mesh)).at(0);
    const std::string text =
        checks::error_of<NumericalFailure>([&] { make_flattening_problem(mesh, tube); });
    EXPECT_TRUE(checks::contains(text, "2 boundary loops"));
    EXPECT_TRUE(checks::contains(text, "Charts: Cut to Disks"));
}

} // namespace
} // namespace devseg::flatten
