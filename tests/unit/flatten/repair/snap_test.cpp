#include "devseg/flatten/repair/snap.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using shapes::Random;

std::vector<Vec2> rounded(std::vector<Vec2> uv) {
    for (Vec2& p : uv)
        p = checks::single(p);
    return uv;
}

bool all_single(const std::vector<Vec2>& uv) {
    return rounded(uv) == uv;
}

struct Map {
    std::vector<Triangle> faces;
    std::vector<Vec2> uv;
};

// A straight strip of `count` slivers of the given height, along a slope.
Map sliver_strip(int count, double slope, double height, const Vec2& start) {
    Map map;
    const double step = 0.2 / count;
    const Vec2 along = Vec2(1.0, slope).normalized();
    const Vec2 across(-along.y(), along.x());
    for (int i = 0; i <= count; ++i) {
        map.uv.push_back(start + i * step * along);
        map.uv.push_back(start + (i + 0.5) * step * along + height * across);
        if (i == 0)
            continue;
        const Index n = static_cast<Index>(map.uv.size());
        map.faces.push_back({n - 4, n - 2, n - 3});
        map.faces.push_back({n - 3, n - 2, n - 1});
    }
    return map;
}

// A regular grid, distorted so that some triangles are thin.
Map thin_grid(Index n, double height, std::uint32_t seed) {
    Map map;
    Random random(seed);
    const double slope = random.uniform(-1.0, 1.0);
    for (Index y = 0; y <= n; ++y)
        for (Index x = 0; x <= n; ++x) {
            const double u = 0.4 + 0.2 * x / n;
            map.uv.emplace_back(u, 0.4 + slope * u + height * y);
        }
    for (Index y = 0; y < n; ++y)
        for (Index x = 0; x < n; ++x) {
            const Index a = y * (n + 1) + x;
            map.faces.push_back({a, a + 1, a + n + 2});
            map.faces.push_back({a, a + n + 2, a + n + 1});
        }
    return map;
}

TEST(Snap, OrdinaryMapsAreJustRounded) {
    const Map map = thin_grid(20, 0.01, 1);
    std::vector<Vec2> uv = map.uv;
    EXPECT_EQ(snap_to_single(map.faces, uv), 0);
    EXPECT_EQ(uv, rounded(map.uv));
    EXPECT_NE(uv, map.uv);
}

TEST(Snap, SliversThatRoundingWouldFlipAreKept) {
    // Near ½, neighbouring single precision numbers are 6e-8 apart.
    for (const double height : {3e-8, 2e-8, 1e-8})
        for (const double slope : {0.1, -0.77, 3.3}) {
            const Map map = sliver_strip(60, slope, height, Vec2(0.55, 0.51));
            ASSERT_EQ(checks::count_flips(map.faces, map.uv), 0);
            ASSERT_GT(checks::count_flips(map.faces, rounded(map.uv)), 0) << height; // it matters
            std::vector<Vec2> uv = map.uv;
            EXPECT_EQ(snap_to_single(map.faces, uv), 0) << height << ' ' << slope;
            EXPECT_EQ(checks::count_flips(map.faces, uv), 0);
            EXPECT_TRUE(all_single(uv));
            for (std::size_t v = 0; v < uv.size(); ++v)
                EXPECT_LT((uv[v] - map.uv[v]).norm(), 2e-6);
        }
}

TEST(Snap, ThinGridsAreKept) {
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        const Map map = thin_grid(24, 1e-8, seed);
        ASSERT_EQ(checks::count_flips(map.faces, map.uv), 0);
        ASSERT_GT(checks::count_flips(map.faces, rounded(map.uv)), 0);
        std::vector<Vec2> uv = map.uv;
        EXPECT_EQ(snap_to_single(map.faces, uv), 0) << "seed " << seed;
        EXPECT_EQ(checks::count_flips(map.faces, uv), 0);
        EXPECT_TRUE(all_single(uv));
    }
}

double farthest_move(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    double farthest = 0.0;
    for (std::size_t v = 0; v < a.size(); ++v)
        farthest = std::max(farthest, (a[v] - b[v]).norm());
    return farthest;
}

TEST(Snap, LayersThatNumbersCannotTellApartGetRoom) {
    for (const double height : {1e-11, 1e-9, 1e-8}) {
        const Map map = thin_grid(12, height, 9);
        ASSERT_GT(checks::count_flips(map.faces, rounded(map.uv)), 0);
        std::vector<Vec2> uv = map.uv;
        EXPECT_EQ(snap_to_single(map.faces, uv), 0) << height;
        EXPECT_TRUE(all_single(uv));
        EXPECT_EQ(checks::count_flips(map.faces, uv), 0);
        EXPECT_LT(farthest_move(uv, map.uv), 12 * 4 * 6e-8 + 1e-6); // twelve layers of four steps
    }
}

// A part of a chart as small as a step of the numbers, in the middle of large faces.
TEST(Snap, SpecksGrow) {
    Map map = thin_grid(8, 0.01, 3);
    const Vec2 middle = map.uv[40];
    for (Index y = 2; y <= 6; ++y)
        for (Index x = 2; x <= 6; ++x) {
            Vec2& p = map.uv[static_cast<std::size_t>(y * 9 + x)];
            p = middle + 1e-9 * (p - middle);
        }
    ASSERT_EQ(checks::count_flips(map.faces, map.uv), 0);
    ASSERT_GT(checks::count_flips(map.faces, rounded(map.uv)), 0);
    std::vector<Vec2> uv = map.uv;
    EXPECT_EQ(snap_to_single(map.faces, uv), 0);
    EXPECT_EQ(checks::count_flips(map.faces, uv), 0);
    EXPECT_LT(farthest_move(uv, map.uv), 1e-5);
}

// Rounding alone would leave the lowest face less than half of its height.
TEST(Snap, NoFaceIsStretchedMuch) {
    Map map = sliver_strip(12, 0.41, 4e-8, Vec2(0.55, 0.51));
    const auto least_height = [&](const std::vector<Vec2>& uv) {
        double least = 1.0;
        for (const Triangle& t : map.faces) {
            const Vec2 a = uv[t[1]] - uv[t[0]];
            const Vec2 b = uv[t[2]] - uv[t[0]];
            least = std::min(least, (a.x() * b.y() - a.y() * b.x()) /
                                        std::max({a.norm(), b.norm(), (b - a).norm()}));
        }
        return least;
    };
    EXPECT_LT(least_height(rounded(map.uv)), 2e-8);
    std::vector<Vec2> uv = map.uv;
    snap_to_single(map.faces, uv);
    EXPECT_GT(least_height(uv), 6e-8);
}

TEST(Snap, AFanAroundOnePointIsKept) {
    // Sixty-four slivers around a vertex at single precision's end: the fan has to grow.
    Map map;
    map.uv.emplace_back(0.7123456789, 0.6234567891);
    constexpr Index count = 64;
    for (Index i = 0; i < count; ++i) {
        const double t = 2.0 * 3.14159265358979323846 * i / count;
        map.uv.push_back(map.uv[0] + 4e-7 * Vec2(std::cos(t), std::sin(t)));
        map.faces.push_back({0, 1 + i, 1 + (i + 1) % count});
    }
    std::vector<Vec2> uv = map.uv;
    EXPECT_EQ(snap_to_single(map.faces, uv), 0);
    EXPECT_TRUE(all_single(uv));
    EXPECT_EQ(checks::count_flips(map.faces, uv), 0);
    EXPECT_GT(checks::count_flips(map.faces, rounded(map.uv)), 0);
}

TEST(Snap, IsStable) {
    const Map map = sliver_strip(40, 0.3, 2e-8, Vec2(0.6, 0.7));
    std::vector<Vec2> once = map.uv;
    snap_to_single(map.faces, once);
    std::vector<Vec2> twice = once;
    EXPECT_EQ(snap_to_single(map.faces, twice), 0);
    EXPECT_EQ(twice, once);
}

TEST(Snap, LayoutsOfAnySizeAreHandled) {
    for (const double scale : {1e-6, 1.0, 1e6}) { // "side by side in model units"
        Map map = sliver_strip(40, 0.4, 2e-8, Vec2(0.6, 0.55));
        for (Vec2& p : map.uv)
            p *= scale;
        ASSERT_GT(checks::count_flips(map.faces, rounded(map.uv)), 0);
        std::vector<Vec2> uv = map.uv;
        EXPECT_EQ(snap_to_single(map.faces, uv), 0);
        EXPECT_EQ(checks::count_flips(map.faces, uv), 0);
    }
}

// A crack in a small part of a large model, which needles fill: without a width of their own they
// are turned over by rounding, one beside another.
TEST(RestoreNeedles, LeavesRoomForRounding) {
    mesh::RawMesh raw = shapes::grid(24, 8, 24.0, 8.0);
    for (Vec3& p : raw.points) {
        const double row = p.y();
        if (row < 2.0 || row > 6.0)
            continue;
        p.y() = 2.0 + 1e-9 * row;
        p.x() += p.x() > 0.0 && p.x() < 24.0 ? 0.3 * std::fmod(row, 3.0) : 0.0;
    }
    const checks::Disk disk(raw);
    FlatteningProblem problem = disk.problem;
    problem.model_size *= 500.0;
    std::vector<Vec2> given;
    for (const Vertex v : disk.surface.vertex)
        given.emplace_back(disk.mesh.points[v].head<2>());
    std::vector<Vec2> uv = given;
    restore_needles(problem, uv);
    const double moved = 1e-5 * problem.model_size;
    for (std::size_t v = 0; v < uv.size(); ++v)
        EXPECT_LT((uv[v] - given[v]).norm(), moved);
    for (Vec2& p : uv)
        p = Vec2(0.7, 0.6) + p / problem.model_size;
    EXPECT_EQ(snap_to_single(problem.faces, uv), 0);
    EXPECT_EQ(checks::count_flips(problem.faces, uv), 0);
}

} // namespace
} // namespace devseg::flatten
