// Charts with holes in the plane.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/holes.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/maps/lpfb.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/overlap.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

constexpr FlattenMethod methods[] = {FlattenMethod::symmetric_dirichlet, FlattenMethod::lscm,
                                     FlattenMethod::abf, FlattenMethod::arap, FlattenMethod::lpfb};

atlas::ChartMap sound_components(const Mesh& mesh) {
    return checks::components_cut_to_disks(mesh);
}

FlattenResult flatten(const Mesh& mesh, FlattenMethod method) {
    Progress progress;
    return flatten_charts(mesh, sound_components(mesh), method, progress);
}

void expect_one_to_one(const Mesh& mesh, const FlatChart& chart) {
    EXPECT_EQ(checks::count_flips(chart.surface.faces, chart.uv), 0);
    CornerUv corners;
    for (const Triangle& t : chart.surface.faces)
        for (const Vertex v : t)
            corners.push_back(chart.uv[v]);
    EXPECT_TRUE(
        plane::find_overlapping_pairs(corners, plane::layout_tolerance(std::sqrt(mesh.total_area)))
            .empty());
}

// A flat ring with a hole of radius 1, which becomes a bowl from radius 2 on.
mesh::RawMesh bowl_with_hole() {
    std::vector<Vec2> profile;
    for (int i = 0; i <= 12; ++i) {
        const double r = 4.0 - 0.25 * i;
        profile.emplace_back(r, 0.25 * std::pow(std::max(0.0, r - 2.0), 2.0));
    }
    return shapes::revolve(profile, 48);
}

TEST(HolesInThePlane, PlatesKeepTheirHolesByEveryMethod) {
    const Mesh mesh = checks::gated(shapes::plate(shapes::mask_with_holes(4)));
    for (const FlattenMethod method : methods) {
        const FlattenResult result = flatten(mesh, method);
        ASSERT_EQ(result.flat.size(), 1U);
        EXPECT_EQ(result.cuts, 0);
        EXPECT_EQ(result.charts.seam, std::vector<std::uint8_t>(mesh.twin.size(), 0));
        const FlatChart& chart = result.flat.front();
        EXPECT_EQ(chart.surface.loops.size(), 5U);
        EXPECT_TRUE(chart.developed);
        EXPECT_NEAR(chart.energy, 1.0, 1e-12);
        expect_one_to_one(mesh, chart);
    }
}

TEST(HolesInThePlane, CurvedChartsKeepFlatOnes) {
    const Mesh mesh = checks::gated(bowl_with_hole());
    for (const FlattenMethod method : methods) {
        const FlattenResult result = flatten(mesh, method);
        ASSERT_EQ(result.flat.size(), 1U);
        EXPECT_EQ(result.cuts, 0);
        const FlatChart& chart = result.flat.front();
        EXPECT_EQ(chart.surface.loops.size(), 2U);
        EXPECT_FALSE(chart.developed);
        EXPECT_FALSE(chart.mended);
        EXPECT_LT(chart.energy, 1.1);
        expect_one_to_one(mesh, chart);
        if (method == FlattenMethod::lpfb)
            for (const std::vector<Index>& loop : chart.surface.loops)
                for (const HalfEdge h : loop) {
                    const double length = mesh.edge_length(chart.surface.mesh_half_edge(h));
                    const Vec2 edge =
                        chart.uv[chart.surface.target(h)] - chart.uv[chart.surface.origin(h)];
                    EXPECT_NEAR(edge.norm(), length, 1e-6 * length);
                }
    }
}

TEST(HolesInThePlane, MapsOfOneBoundaryRefuseThem) {
    const Mesh mesh = checks::gated(bowl_with_hole());
    const auto problem =
        make_flattening_problem(mesh, atlas::extract_charts(mesh, sound_components(mesh)).at(0));
    ASSERT_EQ(problem.holes.size(), 1U);
    EXPECT_EQ(problem.holes.front().size(), 48U);
    EXPECT_EQ(problem.boundary.size(), 48U);
    const Progress progress;
    EXPECT_THROW(flatten_tutte(problem), NumericalFailure);
    EXPECT_THROW(flatten_lpfb(problem, LpfbOptions{}, progress), NumericalFailure);
}

TEST(HolesInThePlane, TheSheetMustCloseAroundThem) {
    const Mesh flat = checks::gated(shapes::annulus(24, 2, 1.0, 2.0));
    EXPECT_TRUE(unfold(make_flattening_problem(
        flat, atlas::extract_charts(flat, checks::components(flat)).at(0))));
    // Within what a map bears, but no development.
    const Mesh cone = checks::gated(shapes::frustum(24, 2, 2.0, 1.0, 0.05));
    const auto surface = atlas::extract_charts(cone, checks::components(cone)).at(0);
    ASSERT_TRUE(atlas::is_sound(cone, surface));
    EXPECT_FALSE(unfold(make_flattening_problem(cone, surface)));
    EXPECT_NEAR(flatten(cone, FlattenMethod::symmetric_dirichlet).flat.front().energy, 1.0, 1e-4);
}

// The hole of one sheet is no licence for another to lie in it and on the rim.
TEST(HolesInThePlane, OverlapsAcrossAHoleAreFound) {
    const Mesh mesh = checks::gated(shapes::annulus(16, 2, 1.0, 2.0));
    const auto surface = atlas::extract_charts(mesh, checks::components(mesh)).at(0);
    std::vector<Vec2> uv;
    for (const Vertex v : surface.vertex)
        uv.emplace_back(mesh.points[v].head<2>());
    EXPECT_TRUE(is_one_to_one(surface, uv));
    EXPECT_TRUE(overlapping_pairs(surface, uv, 1e-9).empty());
    // Twice around: the angle is doubled.
    for (Vec2& p : uv) {
        const double angle = 2.0 * std::atan2(p.y(), p.x());
        p = p.norm() * Vec2(std::cos(angle), std::sin(angle));
    }
    EXPECT_FALSE(is_one_to_one(surface, uv));
}

// A plate with a slit, whose lips lie on each other.
mesh::RawMesh lips(double overlap) {
    mesh::RawMesh raw;
    const double y = 0.5 * overlap;
    raw.points = {{-3, -2, 0}, {3, -2, 0}, {3, 2, 0},         {-3, 2, 0},
                  {-1, 0, 0},  {1, 0, 0},  {0, -y, 0.25 * y}, {0, y, -0.25 * y}};
    raw.faces = {{0, 1, 7}, {1, 5, 7}, {1, 2, 5}, {2, 6, 5},
                 {2, 3, 6}, {3, 4, 6}, {3, 0, 4}, {0, 7, 4}};
    return raw;
}

// No edge of the boundary crosses another where lips close over their whole length.
TEST(HolesInThePlane, TurnedInsideOutTheyAreOverlaps) {
    const Mesh mesh = checks::gated(lips(0.1));
    const auto surface = atlas::extract_charts(mesh, checks::components(mesh)).at(0);
    ASSERT_TRUE(atlas::is_sound(mesh, surface));
    std::vector<Vec2> uv;
    for (const Vertex v : surface.vertex)
        uv.emplace_back(mesh.points[v].head<2>());
    ASSERT_EQ(checks::count_flips(surface.faces, uv), 0);
    EXPECT_FALSE(is_one_to_one(surface, uv));
    EXPECT_FALSE(overlapping_pairs(surface, uv, 1e-9).empty());
    for (const FlattenMethod method : methods)
        for (const FlatChart& chart : flatten(mesh, method).flat)
            expect_one_to_one(mesh, chart);
}

} // namespace
} // namespace devseg::flatten
