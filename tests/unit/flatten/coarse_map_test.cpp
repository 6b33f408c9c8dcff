// Large charts by way of a coarse version.
#include "devseg/flatten/coarse_map.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/overlap.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;

atlas::ChartMap one_chart(const Mesh& mesh) {
    return atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), {}, false);
}

FlatChart whole(const Disk& disk) {
    Progress progress;
    WholeChart asked;
    asked.is_good = [](const FlatteningProblem&, const std::vector<Vec2>&) { return true; };
    return flatten_whole(disk.mesh, one_chart(disk.mesh), FlattenMethod::symmetric_dirichlet, asked,
                         progress)
        .front();
}

void expect_one_to_one(const Disk& disk, const std::vector<Vec2>& uv) {
    EXPECT_EQ(checks::count_flips(disk.problem.faces, uv), 0);
    EXPECT_FALSE(
        overlaps_itself(disk.surface, uv, plane::layout_tolerance(disk.problem.model_size)));
}

TEST(CoarseMap, IsNearTheBestOneWhereNothingOverlaps) {
    const Disk disk(shapes::ramp(1.0, 0.03));
    const FlatChart best = whole(disk);
    ASSERT_FALSE(best.torn || best.pushed);
    const auto map = map_by_coarse(disk.mesh, disk.surface, disk.problem, Progress());
    ASSERT_TRUE(map);
    expect_one_to_one(disk, *map);
    EXPECT_LT(symmetric_dirichlet_energy(disk.problem, *map), best.energy + 1e-4);
}

TEST(CoarseMap, ComesApartWhereAllFacesDoNot) {
    const Disk disk(shapes::ramp(1.07, 0.02));
    ASSERT_TRUE(whole(disk).torn);
    const auto map = map_by_coarse(disk.mesh, disk.surface, disk.problem, Progress());
    ASSERT_TRUE(map);
    expect_one_to_one(disk, *map);
    Progress progress;
    const FlattenResult r = flatten_charts(disk.mesh, one_chart(disk.mesh),
                                           FlattenMethod::symmetric_dirichlet, progress);
    EXPECT_EQ(r.cuts, 0);
    ASSERT_EQ(r.flat.size(), 1U);
    EXPECT_EQ(r.flat.front().uv, *map);
    EXPECT_TRUE(r.flat.front().pushed);
    EXPECT_LT(r.flat.front().energy, 1.01);
}

TEST(CoarseMap, OfSmallChartsAndOfExactDevelopmentsThereIsNone) {
    const Disk small(shapes::hemisphere(60, 20));
    ASSERT_LE(small.surface.face_count(), coarse_map_faces);
    EXPECT_FALSE(map_by_coarse(small.mesh, small.surface, small.problem, Progress()));
    const Disk plane(shapes::grid(100, 100));
    ASSERT_GT(plane.surface.face_count(), coarse_map_faces);
    EXPECT_FALSE(map_by_coarse(plane.mesh, plane.surface, plane.problem, Progress()));
}

} // namespace
} // namespace devseg::flatten
