#include "devseg/plane/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::plane {
namespace {

using checks::common_area;
using checks::Corners;
using shapes::pi;
using shapes::Random;

Corners corners_of(const CornerUv& uv, std::size_t f) {
    return {uv[3 * f], uv[3 * f + 1], uv[3 * f + 2]};
}

CornerUv soup(Random& random, int count, double size, bool slivers) {
    CornerUv uv;
    for (int f = 0; f < count; ++f) {
        const Vec2 centre(random.uniform(0.0, 1.0), random.uniform(0.0, 1.0));
        const double thin = slivers && random.below(3) == 0 ? 1e-3 : 1.0;
        const double turn = random.uniform(0.0, 2.0 * pi);
        for (int k = 0; k < 3; ++k) // any orientation
            uv.push_back(centre +
                         Eigen::Rotation2Dd(turn) * Vec2(size * random.uniform(-1.0, 1.0),
                                                         thin * size * random.uniform(-1.0, 1.0)));
    }
    return uv;
}

// Every pair against clipping. Pairs that share less than `unsure` may be reported or not.
void expect_clipped_pairs(const CornerUv& uv, double unsure) {
    const auto pairs = find_overlapping_pairs(uv, 0.0);
    EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
    const std::set<std::pair<Index, Index>> found(pairs.begin(), pairs.end());
    EXPECT_EQ(found.size(), pairs.size()) << "a pair is reported twice";
    for (Index i = 0; i < static_cast<Index>(uv.size() / 3); ++i)
        for (Index j = i + 1; j < static_cast<Index>(uv.size() / 3); ++j) {
            const double shared = common_area(corners_of(uv, at(i)), corners_of(uv, at(j)));
            if (shared > unsure) {
                ASSERT_TRUE(found.count({i, j}) == 1) << i << ' ' << j << ' ' << shared;
            } else if (shared <= 0.0) {
                ASSERT_TRUE(found.count({i, j}) == 0) << i << ' ' << j;
            }
        }
}

TEST(OverlappingPairs, AgreeWithClippingOnRandomSoups) {
    for (std::uint32_t seed = 1; seed <= 6; ++seed)
        for (const double size : {0.02, 0.1, 0.7})
            for (const bool slivers : {false, true}) {
                Random random(seed);
                expect_clipped_pairs(soup(random, 150, size, slivers), 1e-5 * size * size);
            }
}

TEST(OverlappingPairs, AgreeWithClippingOnLayoutsOfUnevenSize) {
    Random random(77);
    CornerUv uv = soup(random, 60, 1e-3, false); // a crowd in one place, large ones over it
    const CornerUv large = soup(random, 20, 3.0, false);
    uv.insert(uv.end(), large.begin(), large.end());
    uv.insert(uv.end(), {{1e3, 1e3}, {1e3 + 1.0, 1e3}, {1e3, 1e3 + 1.0}}); // and one far away
    expect_clipped_pairs(uv, 1e-10);
}

TEST(OverlappingPairs, LineUpsOfTrianglesInOneRow) {
    CornerUv uv; // the grid of cells is long and flat
    for (int i = 0; i < 200; ++i)
        for (const Vec2& p : {Vec2(0, 0), Vec2(1.5, 0), Vec2(0, 1e-4)})
            uv.push_back(p + Vec2(i, 0.0));
    const auto pairs = find_overlapping_pairs(uv, 0.0);
    EXPECT_EQ(pairs.size(), 199U);
    for (const auto& [i, j] : pairs)
        EXPECT_EQ(j, i + 1);
}

TEST(OverlappingPairs, TouchingIsNotOverlapping) {
    const CornerUv shared_edge = {{0, 0}, {1, 0}, {0, 1}, {1, 0}, {1, 1}, {0, 1}};
    EXPECT_TRUE(find_overlapping_pairs(shared_edge, 0.0).empty());
    const CornerUv shared_corner = {{0, 0}, {1, 0}, {0, 1}, {1, 0}, {2, 0}, {2, 1}};
    EXPECT_TRUE(find_overlapping_pairs(shared_corner, 0.0).empty());
    CornerUv deeper = shared_edge; // by a third of the millionth that is allowed
    for (std::size_t i = 3; i < 6; ++i)
        deeper[i] -= Vec2(3e-7, 3e-7);
    EXPECT_TRUE(find_overlapping_pairs(deeper, 0.0).empty());
    deeper = shared_edge; // by more
    for (std::size_t i = 3; i < 6; ++i)
        deeper[i] -= Vec2(1e-5, 1e-5);
    EXPECT_EQ(find_overlapping_pairs(deeper, 0.0).size(), 1U);
    EXPECT_TRUE(any_overlap(deeper, 0.0));
    EXPECT_TRUE(find_overlapping_pairs(deeper, 1e-4).empty()); // but not beyond the tolerance
    EXPECT_FALSE(any_overlap(deeper, 1e-4));
}

TEST(OverlappingPairs, EqualTrianglesOverlapWhateverTheirOrientation) {
    const CornerUv uv = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {0, 1}, {1, 0}, {0, 1}, {0, 0}, {1, 0}};
    EXPECT_EQ(find_overlapping_pairs(uv, 0.0).size(), 3U);
}

TEST(OverlappingPairs, OneInsideTheOther) {
    const CornerUv uv = {{0, 0}, {10, 0}, {0, 10}, {2, 2}, {3, 2}, {2, 3}};
    EXPECT_EQ(find_overlapping_pairs(uv, 0.0).size(), 1U);
}

TEST(OverlappingPairs, TrianglesWithoutAreaOverlapNothing) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const CornerUv uv = {{0, 0},     {10, 0},    {0, 10},  {1, 1}, {2, 2}, {3, 3},
                         {nan, nan}, {nan, nan}, {nan, 1}, {4, 4}, {4, 4}, {4, 4}};
    EXPECT_TRUE(find_overlapping_pairs(uv, 0.0).empty());
    EXPECT_TRUE(find_overlapping_pairs({}, 0.0).empty());
    EXPECT_FALSE(any_overlap({}, 0.0));
    EXPECT_TRUE(find_overlapping_pairs({{1, 1}, {1, 1}, {1, 1}}, 0.0).empty());
}

TEST(OverlappingPairs, PlaneTriangulationsHaveNone) {
    for (const mesh::RawMesh& raw : {shapes::grid(20, 15), shapes::annulus(40, 6, 1.0, 2.0)}) {
        CornerUv uv;
        for (const Triangle& t : raw.faces)
            for (const Index v : t)
                uv.push_back(raw.points[v].head<2>());
        for (const double scale : {1e-6, 1.0, 1e6}) {
            CornerUv scaled = uv;
            for (Vec2& p : scaled)
                p = checks::single(scale * p); // as hosts store them
            EXPECT_EQ(find_overlapping_faces(scaled),
                      std::vector<std::uint8_t>(raw.faces.size(), 0));
        }
    }
}

TEST(OverlappingFaces, MarksAllFacesOfOverlappingPairs) {
    Random random(5);
    const CornerUv uv = soup(random, 200, 0.06, false);
    std::vector<std::uint8_t> expected(200, 0);
    for (const auto& [i, j] : find_overlapping_pairs(uv, layout_tolerance(1.1)))
        expected[i] = expected[j] = 1;
    EXPECT_EQ(find_overlapping_faces(uv), expected);
    EXPECT_GT(std::count(expected.begin(), expected.end(), 1), 20);
    EXPECT_GT(std::count(expected.begin(), expected.end(), 0), 20);
}

TEST(OverlappingFaces, AStripThatRunsOverItself) {
    // One and a half turns of a ring: the first and the last third of its faces overlap.
    const mesh::RawMesh raw = shapes::helix_strip(90, 1.5, 1.0, 2.0, 1.0);
    CornerUv uv;
    for (const Triangle& t : raw.faces)
        for (const Index v : t)
            uv.push_back(raw.points[v].head<2>());
    const std::vector<std::uint8_t> overlapping = find_overlapping_faces(uv);
    for (std::size_t f = 0; f < overlapping.size(); ++f)
        EXPECT_EQ(overlapping[f], f < 60 || f >= 120 ? 1 : 0) << f;
}

} // namespace
} // namespace devseg::plane
