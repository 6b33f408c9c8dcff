#include "devseg/flatten/repair/overlaps.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;

constexpr double tolerance = 1e-6;

std::optional<std::vector<Vec2>> push(const Disk& disk, const std::vector<Vec2>& uv) {
    return push_apart(disk.problem, disk.surface, uv,
                      overlapping_pairs(disk.surface, uv, tolerance), tolerance, Progress());
}

// A strip with two long teeth that stand beside each other.
mesh::RawMesh comb() {
    mesh::RawMesh raw;
    raw.points = {{0, 0, 0}, {3, 0, 0}, {0, 1, 0},   {1, 1, 0},
                  {2, 1, 0}, {3, 1, 0}, {0.5, 5, 0}, {2.5, 5, 0}};
    raw.faces = {{0, 1, 5}, {0, 5, 4}, {0, 4, 3}, {0, 3, 2}, {2, 3, 6}, {4, 5, 7}};
    return raw;
}

TEST(PushApart, ResolvesEdgesThatCrossWithoutAVertexInside) {
    const Disk disk(comb());
    std::vector<Vec2> uv;
    for (const Vertex v : disk.surface.vertex)
        uv.emplace_back(disk.mesh.points[v].head<2>());
    scale_to_area(disk.problem, uv);
    std::vector<std::size_t> order{0, 1, 2, 3, 4, 5, 6, 7};
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return uv[a].y() > uv[b].y(); });
    Vec2& tip = uv[order[0]];
    Vec2& other = uv[order[1]];
    tip.x() = -0.2 * tip.x(); // past the other one, which comes half the way
    other.x() = -0.2 * other.x();
    ASSERT_EQ(count_flips(disk.problem, uv), 0);
    ASSERT_TRUE(overlaps_itself(disk.surface, uv, tolerance));
    const auto apart = push(disk, uv);
    ASSERT_TRUE(apart.has_value());
    EXPECT_FALSE(overlaps_itself(disk.surface, *apart, tolerance));
    EXPECT_EQ(checks::count_flips(disk.problem.faces, *apart), 0);
}

// It starts on one sheet and ends on another: no little push will do.
TEST(PushApart, LeavesWhatRunsOverItselfToACut) {
    const Disk disk(shapes::helix_strip(60, 1.6, 20.0, 30.0, 0.5));
    std::vector<Vec2> uv(at(disk.problem.vertex_count));
    for (std::size_t v = 0; v < uv.size(); ++v)
        uv[v] = disk.mesh.points[disk.surface.vertex[v]].head<2>();
    if (map_area(disk.problem, uv) < 0.0)
        for (Vec2& p : uv)
            p.y() = -p.y();
    scale_to_area(disk.problem, uv);
    ASSERT_EQ(count_flips(disk.problem, uv), 0);
    ASSERT_TRUE(overlaps_itself(disk.surface, uv, tolerance));
    EXPECT_FALSE(push(disk, uv).has_value());
}

} // namespace
} // namespace devseg::flatten
