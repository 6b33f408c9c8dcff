#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/holes.h"
#include "devseg/atlas/texture.h"
#include "devseg/flatten/flatten.h"
#include "devseg/mesh/input_gate.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

// A plate in two charts, and a piece of two squares at its lower edge between them.
Mesh plate() {
    return mesh::gate_mesh(shapes::grid(20, 20, 20.0, 20.0)).mesh;
}

FlattenResult flat_with_sliver(const Mesh& mesh) {
    const Vec3 low = mesh.points.front();
    const double side = (mesh.points.back() - low).x() / 20.0;
    std::vector<Index> label;
    for (const Vec3& center : mesh.face_centers) {
        const Vec3 p = (center - low) / side;
        label.push_back(p.x() > 10.0 && p.x() < 11.0 && p.y() < 2.0 ? 2 : p.x() < 10.0 ? 0 : 1);
    }
    Progress progress;
    return flatten_charts(mesh, atlas::make_chart_map(mesh, label, {}, false),
                          FlattenMethod::symmetric_dirichlet, progress);
}

Index sliver_of(const FlattenResult& flat) {
    for (Index c = 0; c < flat.charts.count; ++c)
        if (flat.flat[c].surface.face_count() == 4)
            return c;
    return -1;
}

TEST(Slivers, GoToANeighbourThatHasRoom) {
    const Mesh mesh = plate();
    FlattenResult flat = flat_with_sliver(mesh);
    ASSERT_EQ(flat.charts.count, 3);
    flat.flat[sliver_of(flat)].cut_off = true;
    Progress progress;
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, flat, progress);
    ASSERT_EQ(flat.charts.count, 2);
    ASSERT_EQ(flat.flat.size(), 2U);
    EXPECT_TRUE(checks::is_valid(mesh, flat.charts));
    Index faces = 0;
    for (Index c = 0; c < 2; ++c) {
        const FlatChart& chart = flat.flat[c];
        faces += chart.surface.face_count();
        EXPECT_NEAR(chart.energy, 1.0, 1e-9);
        EXPECT_EQ(checks::count_flips(chart.surface.faces, chart.uv), 0);
        for (const Index f : chart.surface.face)
            EXPECT_EQ(flat.charts.chart[f], c);
    }
    EXPECT_EQ(faces, mesh.face_count());
}

TEST(Slivers, ChartsThatWereGivenStay) {
    const Mesh mesh = plate();
    FlattenResult flat = flat_with_sliver(mesh);
    Progress progress;
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, flat, progress);
    EXPECT_EQ(flat.charts.count, 3);
}

TEST(Slivers, StayWhereTheJoinedChartWouldBeNoDisk) {
    // A tube but for a gap of one sector, which is its only piece: gluing closes the tube.
    const mesh::RawMesh raw = shapes::cylinder_tube(240, 2, 1.0, 0.03);
    const Mesh mesh = mesh::gate_mesh(raw).mesh;
    std::vector<Index> label(mesh.faces.size(), 0);
    for (std::size_t f = 0; f < label.size(); ++f) {
        const Vec3& p = mesh.face_centers[f];
        label[f] = p.x() > 0.0 && std::abs(p.y()) < 0.03 * p.x() ? 1 : 0;
    }
    Progress progress;
    FlattenResult flat = flatten_charts(mesh, atlas::make_chart_map(mesh, label, {}, false),
                                        FlattenMethod::symmetric_dirichlet, progress);
    const Index before = flat.charts.count;
    ASSERT_GE(before, 2);
    for (FlatChart& chart : flat.flat)
        chart.cut_off = chart.surface.face_count() < 10;
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, flat, progress);
    EXPECT_EQ(flat.charts.count, before);
    for (const FlatChart& chart : flat.flat)
        EXPECT_TRUE(chart.surface.is_disk());
}

TEST(Slivers, CloseAFlatRing) {
    const Mesh mesh = mesh::gate_mesh(shapes::annulus(240, 2, 0.97, 1.0)).mesh;
    std::vector<Index> label(mesh.faces.size(), 0);
    for (std::size_t f = 0; f < label.size(); ++f) {
        const Vec3& p = mesh.face_centers[f];
        label[f] = p.x() > 0.0 && std::abs(p.y()) < 0.03 * p.x() ? 1 : 0;
    }
    Progress progress;
    FlattenResult flat = flatten_charts(mesh, atlas::make_chart_map(mesh, label, {}, false),
                                        FlattenMethod::symmetric_dirichlet, progress);
    for (FlatChart& chart : flat.flat)
        chart.cut_off = chart.surface.face_count() < 10;
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, flat, progress);
    ASSERT_EQ(flat.charts.count, 1);
    EXPECT_EQ(flat.flat.front().surface.loops.size(), 2U);
    EXPECT_TRUE(flat.flat.front().developed);
}

// A square whose middle is raised a little, so that half of the faces around it are a part of their
// own: both unfold, and together nearly.
Index charts_around_a_tip(double height) {
    mesh::RawMesh raw = shapes::grid(20, 20);
    const Index tip = 10 * 21 + 10;
    raw.points[at(tip)].z() += height;
    const Mesh mesh = checks::gated(raw);
    std::vector<Index> label(mesh.faces.size(), 0);
    for (const Face f : mesh.all_faces())
        if (std::count(mesh.faces[f].begin(), mesh.faces[f].end(), tip) > 0)
            label[at(f)] = mesh.face_centers[f].x() > mesh.points[at(tip)].x() ? 1 : 0;
    Progress progress;
    FlattenResult flat = flatten_charts(mesh, atlas::make_chart_map(mesh, label, {}, false),
                                        FlattenMethod::symmetric_dirichlet, progress);
    for (FlatChart& chart : flat.flat) {
        EXPECT_TRUE(chart.developed);
        chart.cut_off = chart.surface.face_count() < 10;
    }
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, flat, progress);
    return flat.charts.count;
}

TEST(Slivers, StayWhereAnAngleOfAnExactChartWouldBeWrong) {
    EXPECT_EQ(charts_around_a_tip(0.0), 1);
    EXPECT_EQ(charts_around_a_tip(1e-4), 2); // 1e-5 radians, and gaps of 5e-7
}

// Charts that readers of the texture coordinates take for disks, or for disks with flat holes.
Index sound_in_the_plane(const Mesh& mesh, const FlattenResult& flat,
                         const atlas::HoleRule& holes) {
    CornerUv uv(3 * mesh.faces.size());
    double shift = 0.0;
    for (const FlatChart& chart : flat.flat) {
        for (std::size_t f = 0; f < chart.surface.face.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k)
                uv[3 * at(chart.surface.face[f]) + k] =
                    chart.uv[chart.surface.faces[f][k]] + Vec2(shift, 0.0);
        shift += 10.0;
    }
    Index sound = 0;
    for (const atlas::ChartSurface& surface :
         atlas::extract_charts(mesh, atlas::charts_from_uv(mesh, uv)))
        sound += atlas::is_sound(mesh, surface, holes) ? 1 : 0;
    return sound;
}

// A sheet with three holes, its last column a chart of its own that goes back to the rest.
void reattach_a_column(const atlas::HoleRule& holes) {
    const Mesh mesh = mesh::gate_mesh(shapes::plate(shapes::mask_with_holes(3))).mesh;
    double right = -1e9;
    for (const Vec3& center : mesh.face_centers)
        right = std::max(right, center.x());
    std::vector<Index> label; // the last column is a chart of its own
    const double cell = std::sqrt(2.0 * mesh.face_areas.front());
    for (const Vec3& center : mesh.face_centers)
        label.push_back(center.x() > right - 0.7 * cell ? 1 : 0);
    Progress progress;
    const atlas::ChartMap cut =
        atlas::cut_charts_to_disks(mesh, atlas::make_chart_map(mesh, label, {}, false),
                                   {false, {}, holes}, progress)
            .charts;
    FlattenResult flat = flatten_charts(mesh, cut, FlattenMethod::symmetric_dirichlet, progress);
    ASSERT_EQ(flat.charts.count, 2);
    EXPECT_EQ(sound_in_the_plane(mesh, flat, holes), 2);

    for (FlatChart& chart : flat.flat) {
        EXPECT_TRUE(chart.developed);
        chart.cut_off = chart.surface.face_count() < mesh.face_count() / 2;
    }
    EXPECT_EQ(reattach_parts(mesh, flat, progress), 1);
    ASSERT_EQ(flat.charts.count, 1);
    EXPECT_EQ(sound_in_the_plane(mesh, flat, holes), 1);
}

// The sides of cuts around holes in a flat sheet lie on each other.
TEST(Reattach, SheetsThatAreCutToDisksAreDisksInThePlane) {
    reattach_a_column(atlas::HoleRule::none());
}

TEST(Reattach, SheetsKeepTheirHoles) {
    reattach_a_column({});
}

} // namespace
} // namespace devseg::flatten
