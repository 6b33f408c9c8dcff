// Variational Shape Approximation and Multi-Chart Geometry Images.
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "devseg/methods/baselines/baselines.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::baselines {
namespace {

VsaResult vsa(const Mesh& mesh, int number, bool teleport = true) {
    VsaOptions options;
    options.charts_number = number;
    options.teleport_charts = teleport;
    Progress progress;
    return segment_vsa(mesh, options, progress);
}

McgimResult mcgim(const Mesh& mesh, int number, int rounds = 100) {
    McgimOptions options;
    options.charts_number = number;
    options.max_iterations = rounds;
    Progress progress;
    return segment_mcgim(mesh, options, progress);
}

void expect_charts(const Mesh& mesh, const std::vector<Index>& chart, int number) {
    ASSERT_EQ(chart.size(), mesh.faces.size());
    const atlas::ChartMap map = atlas::make_chart_map(mesh, chart, {}, false);
    EXPECT_EQ(map.count, number);
    EXPECT_EQ(std::set<Index>(chart.begin(), chart.end()).size(), static_cast<std::size_t>(number));
    EXPECT_TRUE(checks::is_valid(mesh, map));
}

TEST(Vsa, TheSidesOfACube) {
    const Mesh mesh = checks::gated(shapes::cube(6));
    const VsaResult r = vsa(mesh, 6);
    expect_charts(mesh, r.chart, 6);
    EXPECT_NEAR(r.total_error, 0.0, 1e-12);
    for (const Face f : mesh.all_faces())
        EXPECT_NEAR(r.face_error[f], 0.0, 1e-12);
    EXPECT_TRUE(r.converged);
}

TEST(Vsa, TheErrorIsThatOfTheBestPlanes) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::torus(40, 24, 2.0, 0.8), 0.02, 3));
    const VsaResult r = vsa(mesh, 10);
    expect_charts(mesh, r.chart, 10);
    std::vector<Vec3> sum(10, Vec3::Zero());
    for (const Face f : mesh.all_faces())
        sum[r.chart[f]] += mesh.face_areas[f] * mesh.face_normals[f];
    double error = 0.0;
    for (const Face f : mesh.all_faces()) {
        const Vec3 proxy = sum[r.chart[f]].normalized();
        const double deviation = (mesh.face_normals[f] - proxy).squaredNorm();
        EXPECT_NEAR(r.face_error[f], deviation, 1e-12);
        error += mesh.face_areas[f] * deviation;
    }
    EXPECT_NEAR(r.total_error, error, 1e-9 * error);
}

TEST(Vsa, MoreRoundsAndMoreChartsFitBetter) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::torus(40, 24, 2.0, 0.8), 0.02, 3));
    VsaOptions options;
    options.charts_number = 12;
    double before = std::numeric_limits<double>::infinity();
    for (const int rounds : {1, 3, 100}) {
        options.max_iterations = rounds;
        Progress progress;
        const VsaResult r = segment_vsa(mesh, options, progress);
        EXPECT_LE(r.rounds, rounds);
        EXPECT_LE(r.total_error, before);
        before = r.total_error;
    }
    EXPECT_LT(vsa(mesh, 24).total_error, 0.8 * before);
}

TEST(Vsa, TeleportsLeaveBadStarts) {
    // Most seeds land on a wavy plate, which hardly needs them; the ball does.
    mesh::RawMesh plate = shapes::grid(40, 40, 12.0, 12.0);
    for (Vec3& p : plate.points)
        p.z() = 0.02 * std::sin(p.x()) * std::sin(p.y());
    const Mesh mesh = checks::gated(
        shapes::join(plate, shapes::moved(shapes::sphere(3), 1.0, Vec3(6.0, 6.0, 3.0))));
    VsaOptions options;
    options.charts_number = 16;
    options.random_seed = 5; // a start that is even over the surface
    Progress progress;
    const VsaResult with = segment_vsa(mesh, options, progress);
    options.teleport_charts = false;
    Progress again;
    const VsaResult without = segment_vsa(mesh, options, again);
    EXPECT_GT(with.teleports, 0);
    EXPECT_EQ(without.teleports, 0);
    EXPECT_LT(with.total_error, 0.8 * without.total_error);
}

TEST(Mcgim, FacesBelongToTheChartOfTheCheapestPath) {
    // On a plane all normals agree: paths cost their length, and charts are Voronoi regions.
    const Mesh mesh = checks::gated(shapes::grid(24, 24));
    const McgimResult r = mcgim(mesh, 4);
    expect_charts(mesh, r.chart, 4);
    std::vector<double> area(4, 0.0);
    for (const Face f : mesh.all_faces())
        area[r.chart[f]] += mesh.face_areas[f] / mesh.total_area;
    for (const double a : area) {
        EXPECT_GT(a, 0.1);
        EXPECT_LT(a, 0.45);
    }
    // Each face but the seeds has a neighbour of its chart on a cheaper path, one step away.
    int seeds = 0;
    for (const Face f : mesh.all_faces()) {
        double best = std::numeric_limits<double>::infinity();
        for (const HalfEdge h : half_edges_of(f)) {
            const Index twin = mesh.twin[h];
            if (twin >= 0 && r.chart[twin / 3] == r.chart[f])
                best =
                    std::min(best, r.face_cost[twin / 3] +
                                       (mesh.face_centers[twin / 3] - mesh.face_centers[f]).norm());
        }
        if (r.face_cost[f] == 0.0)
            ++seeds;
        else
            EXPECT_NEAR(r.face_cost[f], best, 1e-5);
    }
    EXPECT_EQ(seeds, 4);
}

TEST(Mcgim, SeedsComeToRest) {
    const Mesh mesh = checks::gated(shapes::sphere(3));
    const McgimResult r = mcgim(mesh, 6);
    EXPECT_TRUE(r.converged);
    EXPECT_LT(r.rounds, 100);
    EXPECT_FALSE(mcgim(mesh, 6, 1).converged);
}

TEST(Baselines, EdgeConnectedChartsOnManyShapes) {
    const std::vector<mesh::RawMesh> all = {
        shapes::grid(9, 7),    shapes::double_torus(),        shapes::moebius_strip(30, 3),
        shapes::tetrahedron(), shapes::plate_with_handle(),   shapes::finger(12, 20, 1.0, 9.0),
        shapes::sphere(3),     shapes::capped_cylinder(16, 6)};
    for (std::size_t i = 0; i < all.size(); ++i)
        for (const int number : {1, 2, 4}) {
            SCOPED_TRACE("shape " + std::to_string(i) + ", " + std::to_string(number));
            const Mesh mesh = checks::gated(all[i]);
            expect_charts(mesh, vsa(mesh, number).chart, number);
            expect_charts(mesh, mcgim(mesh, number).chart, number);
        }
}

TEST(Baselines, EveryComponentGetsAChart) {
    const Mesh mesh = checks::gated(
        shapes::join(shapes::sphere(2), shapes::moved(shapes::cube(3), 0.5, Vec3(4, 0, 0))));
    for (const int number : {1, 2, 5}) {
        expect_charts(mesh, vsa(mesh, number).chart, std::max(number, 2));
        expect_charts(mesh, mcgim(mesh, number).chart, std::max(number, 2));
    }
}

TEST(Baselines, RefusalsAndCancelling) {
    const Mesh mesh = checks::gated(shapes::cube(2)); // 48 faces
    for (const int number : {0, 49}) {
        EXPECT_THROW(vsa(mesh, number), InvalidParameter);
        EXPECT_THROW(mcgim(mesh, number), InvalidParameter);
    }
    EXPECT_THROW(mcgim(mesh, 2, 0), InvalidParameter);
    for (int stop = 1; stop <= 2; ++stop) {
        int seen = 0;
        Progress a([&](double, const char*) { return ++seen < stop; });
        EXPECT_THROW(segment_vsa(mesh, VsaOptions{}, a), Cancelled);
        seen = 0;
        Progress b([&](double, const char*) { return ++seen < stop; });
        EXPECT_THROW(segment_mcgim(mesh, McgimOptions{}, b), Cancelled);
    }
}

} // namespace
} // namespace devseg::baselines
