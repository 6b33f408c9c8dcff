#include "devseg/flatten/reattach.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/flatten/flatten.h"
#include "devseg/mesh/input_gate.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg {
namespace {

constexpr double tolerance = 1e-9;

// A plate in two charts, and a piece of two squares at its lower edge between them.
Mesh plate() {
    return gate_mesh(shapes::grid(20, 20, 20.0, 20.0)).mesh;
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
    return flatten_charts(mesh, make_chart_map(mesh, label, {}, false),
                          FlattenMethod::symmetric_dirichlet, progress);
}

Index sliver_of(const FlattenResult& flat) {
    for (Index c = 0; c < flat.charts.count; ++c)
        if (flat.flat[at(c)].surface.face_count() == 4)
            return c;
    return -1;
}

TEST(Slivers, GoToANeighbourThatHasRoom) {
    const Mesh mesh = plate();
    FlattenResult flat = flat_with_sliver(mesh);
    ASSERT_EQ(flat.charts.count, 3);
    flat.flat[at(sliver_of(flat))].cut_off = true;
    Progress progress;
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, tolerance, flat, progress);
    ASSERT_EQ(flat.charts.count, 2);
    ASSERT_EQ(flat.flat.size(), 2U);
    EXPECT_TRUE(checks::is_valid(mesh, flat.charts));
    Index faces = 0;
    for (Index c = 0; c < 2; ++c) {
        const FlatChart& chart = flat.flat[at(c)];
        faces += chart.surface.face_count();
        EXPECT_NEAR(chart.energy, 1.0, 1e-9);
        EXPECT_EQ(checks::count_flips(chart.surface.corners, chart.uv), 0);
        for (const Index f : chart.surface.face)
            EXPECT_EQ(flat.charts.chart[at(f)], c);
    }
    EXPECT_EQ(faces, mesh.face_count());
}

TEST(Slivers, ChartsThatWereGivenStay) {
    const Mesh mesh = plate();
    FlattenResult flat = flat_with_sliver(mesh);
    Progress progress;
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, tolerance, flat, progress);
    EXPECT_EQ(flat.charts.count, 3);
}

TEST(Slivers, StayWhereTheJoinedMapWouldOverlap) {
    // A ring but for a gap of one sector, which is its only piece: gluing closes the ring.
    const RawMesh raw = shapes::annulus(240, 2, 0.97, 1.0);
    const Mesh mesh = gate_mesh(raw).mesh;
    std::vector<Index> label(mesh.faces.size(), 0);
    for (std::size_t f = 0; f < label.size(); ++f) {
        const Vec3& p = mesh.face_centers[f];
        label[f] = p.x() > 0.0 && std::abs(p.y()) < 0.03 * p.x() ? 1 : 0;
    }
    Progress progress;
    FlattenResult flat = flatten_charts(mesh, make_chart_map(mesh, label, {}, false),
                                        FlattenMethod::symmetric_dirichlet, progress);
    const Index before = flat.charts.count;
    ASSERT_GE(before, 2);
    for (FlatChart& chart : flat.flat)
        chart.cut_off = chart.surface.face_count() < 10;
    hand_over_slivers(mesh, FlattenMethod::symmetric_dirichlet, tolerance, flat, progress);
    EXPECT_EQ(flat.charts.count, before);
    for (const FlatChart& chart : flat.flat)
        EXPECT_TRUE(chart.surface.is_disk());
}

} // namespace
} // namespace devseg
