#include "devseg/methods/dcharts/developable_charts.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/disks.h"
#include "devseg/base/parallel.h"
#include "devseg/flatten/flatten.h"
#include "devseg/methods/dcharts/draft.h"
#include "devseg/methods/dcharts/full_charts.h"
#include "devseg/metrics/segmentation.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

DevelopableCharts design(const Mesh& mesh, const DevelopableChartsOptions& options) {
    Progress progress;
    return segment_developable_charts(mesh, options, progress);
}

DevelopableChartsOptions charts(int number) {
    DevelopableChartsOptions options;
    options.charts_number = number;
    return options;
}

// Charts as they are flattened: cut to disks, and their map.
flatten::FlattenResult flatten(const Mesh& mesh, const DevelopableCharts& design) {
    Progress progress;
    const atlas::ChartMap cut =
        atlas::cut_charts_to_disks(
            mesh, atlas::make_chart_map(mesh, design.chart, design.seam, false), progress)
            .charts;
    return flatten::flatten_charts(mesh, cut, flatten::FlattenMethod::symmetric_dirichlet,
                                   progress);
}

double stretch(const Mesh& mesh, const flatten::FlattenResult& result) {
    double sum = 0.0;
    for (const flatten::FlatChart& flat : result.flat) {
        const flatten::FlatteningProblem problem =
            flatten::make_flattening_problem(mesh, flat.surface);
        const double l2 = checks::l2_stretch(problem, flat.uv);
        sum += problem.total_area * l2 * l2;
    }
    return std::sqrt(sum / mesh.total_area);
}

void expect_partition(const Mesh& mesh, const DevelopableCharts& r) {
    ASSERT_EQ(r.chart.size(), mesh.faces.size());
    ASSERT_EQ(r.seam.size(), mesh.twin.size());
    ASSERT_EQ(r.fitting_error.size(), mesh.faces.size());
    const atlas::ChartMap map = atlas::make_chart_map(mesh, r.chart, r.seam, false);
    EXPECT_EQ(map.chart, r.chart); // edge-connected, numbers without gaps
    EXPECT_TRUE(checks::is_valid(mesh, map));
}

mesh::RawMesh noisy_torus() {
    return shapes::with_noise(shapes::torus(40, 24, 2.0, 0.8), 0.02, 21);
}

TEST(DevelopableCharts, PartsOfACreasedSolidAreItsCharts) {
    DevelopableChartsOptions options = charts(3);
    options.merge_charts = false;
    const Mesh mesh = checks::gated(shapes::capped_cylinder(48, 12));
    const DevelopableCharts r = design(mesh, options);
    expect_partition(mesh, r);
    EXPECT_EQ(1 + *std::max_element(r.chart.begin(), r.chart.end()), 3);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index twin = mesh.twin[h];
        const bool crease = mesh.face_normals[h / 3].dot(mesh.face_normals[twin / 3]) < 0.5;
        EXPECT_EQ(r.chart[h / 3] != r.chart[twin / 3], crease);
    }
    EXPECT_NEAR(stretch(mesh, flatten(mesh, r)), 1.0, 1e-6);
}

TEST(DevelopableCharts, PlanesAreJoinedAcrossStraightCreases) {
    // The faces of a long box: each fits a chart of its own, and all unfold into a net.
    mesh::RawMesh raw = shapes::cube(6);
    for (Vec3& p : raw.points)
        p.z() *= 3.0;
    const Mesh mesh = checks::gated(raw);
    const DevelopableCharts r = design(mesh, charts(6));
    expect_partition(mesh, r);
    EXPECT_LE(1 + *std::max_element(r.chart.begin(), r.chart.end()), 3);
    EXPECT_NEAR(stretch(mesh, flatten(mesh, r)), 1.0, 1e-6);
}

TEST(DevelopableCharts, JoiningLowersTheNumberAndShortensSeams) {
    const Mesh mesh = checks::gated(noisy_torus());
    DevelopableChartsOptions options = charts(16);
    options.add_darts = false;
    const DevelopableCharts joined = design(mesh, options);
    options.merge_charts = false;
    const DevelopableCharts apart = design(mesh, options);
    EXPECT_GT(joined.joins, 0);
    EXPECT_EQ(apart.joins, 0);
    const auto seams = [&](const DevelopableCharts& r) {
        return metrics::seam_length(mesh, flatten(mesh, r).charts);
    };
    EXPECT_LT(seams(joined), seams(apart));
    expect_partition(mesh, joined);
}

TEST(DevelopableCharts, StraighteningShortensBorders) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::sphere(4), 0.01, 5));
    DevelopableChartsOptions options = charts(8);
    options.merge_charts = options.add_darts = false;
    const auto seams = [&] {
        return metrics::seam_length(
            mesh, atlas::make_chart_map(mesh, design(mesh, options).chart, {}, false));
    };
    const double straight = seams();
    options.straighten_boundaries = false;
    EXPECT_LT(straight, 0.9 * seams());
}

// The narrow strip on a large surface, whose borders come from a coarse one.
TEST(DevelopableCharts, BordersLoseTheStepsOfTheCoarseSurface) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::sphere(6), 0.002, 5));
    Progress progress;
    const std::optional<mesh::CoarseMesh> decimation = decimate(mesh, false, 6, progress);
    ASSERT_TRUE(decimation);
    const Mesh& coarse = decimation->mesh;
    ASSERT_LT(coarse.face_count(), mesh.face_count() / 4);
    const DChartsResult grown = segment_dcharts(coarse, charts(6), progress);
    const Draft draft = make_untried_draft(coarse, grown.chart);
    const auto seams = [&](Straightening straightening) {
        const DevelopableCharts full =
            transfer(mesh, decimation, draft, grown.chart, 0.02, straightening, progress);
        return metrics::seam_length(mesh, atlas::make_chart_map(mesh, full.chart, {}, false));
    };
    EXPECT_LT(seams(Straightening::fitting), seams(Straightening::none));
    EXPECT_LT(seams(Straightening::smooth), 0.98 * seams(Straightening::fitting));
}

TEST(DevelopableCharts, DartsLowerTheWorstSpot) {
    const Mesh mesh = checks::gated(shapes::finger(48, 40, 0.5, 3.0));
    Progress progress;
    Draft draft = make_draft(mesh, std::vector<Index>(mesh.faces.size(), 0), {}, 1.005, progress);
    const double before = draft.map.front().linf;
    DartOptions options;
    options.chart = {1.005, 1.2};
    EXPECT_GT(cut_darts(mesh, options, draft, progress), 0);
    EXPECT_LT(draft.map.front().linf, before);
    EXPECT_EQ(draft.tips.empty(), false);
    // What the draft says of the chart with its darts is what a new trial finds.
    const judge::TrialMap again =
        judge::try_chart(mesh, draft.faces.front(), draft.seam, judge::TrialEffort{}, progress);
    EXPECT_NEAR(again.linf, draft.map.front().linf, 1e-3);
}

// The convex hull of two unit circles through each other's centres: one developable piece with two
// curved creases.
Mesh oloid(int steps, int along) {
    const double end = 2.0 * std::acos(-1.0) / 3.0;
    const auto point = [&](int i, int j, double side) -> Vec3 {
        const double a = end * i / steps;
        const double c = std::cos(a);
        const double square = std::abs(i) == steps ? 0.0 : std::max(0.0, 1.0 + 2.0 * c);
        const Vec3 on_first(std::sin(a), -0.5 - c, 0.0);
        const Vec3 on_second(0.0, 0.5 - c / (1.0 + c), side * std::sqrt(square) / (1.0 + c));
        const double m = static_cast<double>(j) / along;
        return j == along ? on_second : (1.0 - m) * on_first + m * on_second;
    };
    mesh::RawMesh
        soup; // both halves of the second circle's arc lie on each other: the gate joins them
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        const Index first = static_cast<Index>(soup.points.size());
        soup.points.insert(soup.points.end(), {a, b, c});
        soup.faces.push_back({first, first + 1, first + 2});
    };
    for (const double side : {1.0, -1.0})
        for (int i = -steps; i < steps; ++i)
            for (int j = 0; j < along; ++j) {
                const Vec3 p[] = {point(i, j, side), point(i + 1, j, side),
                                  point(i + 1, j + 1, side), point(i, j + 1, side)};
                add(p[0], p[1], p[2]);
                add(p[0], p[2], p[3]);
            }
    return mesh::gate_mesh(soup).mesh;
}

TEST(DevelopableCharts, OneSeedDoesNotMakeMoreChartsThanManySeeds) {
    const Mesh mesh = oloid(40, 12);
    DevelopableChartsOptions options = charts(1);
    options.merge_threshold = 0.05;
    const flatten::FlattenResult flat = flatten(mesh, design(mesh, options));
    EXPECT_LE(flat.charts.count, 3);
    EXPECT_LT(stretch(mesh, flat), 1.001);
}

TEST(DevelopableCharts, PathToBorderIsTheShortestOne) {
    const Mesh mesh = checks::gated(shapes::grid(10, 10, 10.0, 10.0));
    std::vector<Index> faces(mesh.faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f)
        faces[f] = static_cast<Index>(f);
    const std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    // The vertex at column 3, row 5 of the grid is 3 edges away from the border.
    const Index vertex = 5 * 11 + 3;
    EXPECT_EQ(atlas::path_to_border(mesh, faces, seam, vertex).size(), 3U);
    EXPECT_TRUE(atlas::path_to_border(mesh, faces, seam, 0).empty());
}

TEST(DevelopableCharts, SplittingDividesAChartAndTriesBoth) {
    const Mesh mesh = checks::gated(noisy_torus());
    Progress progress;
    Draft draft = make_draft(mesh, std::vector<Index>(mesh.faces.size(), 0), {}, 1.005, progress);
    const double before = draft.excess();
    ASSERT_TRUE(split_chart(mesh, charts(1), 1.005, 0, draft, progress));
    EXPECT_GE(draft.charts_number(), 2);
    EXPECT_LT(draft.excess(), before);
    std::size_t faces = 0;
    for (const std::vector<Index>& part : draft.faces)
        faces += part.size();
    EXPECT_EQ(faces, mesh.faces.size());
}

TEST(DevelopableCharts, AutomaticNumberKeepsTheBoundOnTheFinalMap) {
    const Mesh mesh = checks::gated(noisy_torus());
    Index before = 0;
    for (const double bound : {1.05, 1.01, 1.002}) {
        DevelopableChartsOptions options = charts(0);
        options.max_l2_stretch = bound;
        const DevelopableCharts r = design(mesh, options);
        ASSERT_TRUE(r.bounds_kept);
        const double measured = stretch(mesh, flatten(mesh, r));
        EXPECT_LE(measured, bound);
        EXPECT_NEAR(measured, r.l2_stretch, 1e-9);
        const Index count = 1 + *std::max_element(r.chart.begin(), r.chart.end());
        EXPECT_GE(count, before); // a stricter bound never needs fewer charts here
        before = count;
    }
}

TEST(DevelopableCharts, TheWorstSpotKeepsItsBound) {
    const Mesh mesh = checks::gated(noisy_torus());
    for (const double bound : {1.3, 1.15}) {
        DevelopableChartsOptions options = charts(0);
        options.max_l2_stretch = 1.05;
        options.max_linf_stretch = bound;
        const DevelopableCharts r = design(mesh, options);
        ASSERT_TRUE(r.bounds_kept);
        expect_partition(mesh, r);
        double worst = 1.0;
        for (const flatten::FlatChart& flat : flatten(mesh, r).flat) {
            const flatten::FlatteningProblem problem =
                flatten::make_flattening_problem(mesh, flat.surface);
            for (std::size_t f = 0; f < problem.faces.size(); ++f)
                worst = std::max(worst, 1.0 / checks::stretches(problem, flat.uv, f)[1]);
        }
        EXPECT_LE(worst, bound);
        EXPECT_NEAR(worst, r.linf_stretch, 1e-6);
    }
}

TEST(DevelopableCharts, TheTightestBoundIsKeptBecauseFacesAreIsometric) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::sphere(3), 0.05, 3));
    DevelopableChartsOptions options = charts(0);
    options.max_l2_stretch = 1.0 + 1e-9;
    EXPECT_TRUE(design(mesh, options).bounds_kept);
}

TEST(DevelopableCharts, LargeSurfacesAreDecidedOnACoarseVersion) {
    // 20,480 faces: coarsened. The charts must still be disks without slivers once cut.
    const Mesh mesh = checks::gated(shapes::sphere(5));
    const DevelopableCharts r = design(mesh, charts(8));
    expect_partition(mesh, r);
    const flatten::FlattenResult flat = flatten(mesh, r);
    std::vector<double> area(flat.flat.size());
    for (std::size_t c = 0; c < flat.flat.size(); ++c) {
        EXPECT_TRUE(flat.flat[c].surface.is_disk());
        for (const Index f : flat.flat[c].surface.face)
            area[c] += mesh.face_areas[f];
        EXPECT_GE(area[c], 0.002 * mesh.total_area);
    }
    EXPECT_LT(stretch(mesh, flat), 1.01);
}

TEST(DevelopableCharts, TheNumberOfThreadsDoesNotMatter) {
    const Mesh mesh = checks::gated(noisy_torus());
    set_thread_limit(1);
    const DevelopableCharts one = design(mesh, charts(9));
    set_thread_limit(4);
    const DevelopableCharts four = design(mesh, charts(9));
    set_thread_limit(0);
    EXPECT_EQ(one.chart, four.chart);
    EXPECT_EQ(one.seam, four.seam);
}

TEST(DevelopableCharts, SeveralComponentsAndOpenSurfacesWork) {
    mesh::RawMesh raw = shapes::cone(24, 8);
    const mesh::RawMesh other = shapes::moved(shapes::torus(20, 12), 1.0, Vec3(9, 0, 0));
    const Index base = static_cast<Index>(raw.points.size());
    raw.points.insert(raw.points.end(), other.points.begin(), other.points.end());
    for (const Triangle& t : other.faces)
        raw.faces.push_back({t[0] + base, t[1] + base, t[2] + base});
    const Mesh mesh = checks::gated(raw);
    const DevelopableCharts r = design(mesh, charts(2));
    expect_partition(mesh, r);
    EXPECT_GE(1 + *std::max_element(r.chart.begin(), r.chart.end()), 2);
}

// One spike on a large plate: a cone fits all faces but a few.
TEST(DevelopableCharts, ASpikeIsCutUntilTheBoundHolds) {
    mesh::RawMesh raw = shapes::grid(60, 60, 60.0, 60.0);
    raw.points[60 * 31 + 30].z() += 1.5;
    const Mesh mesh = checks::gated(raw);
    DevelopableChartsOptions options = charts(0);
    options.max_linf_stretch = 1.05;
    options.add_darts = false;
    const DevelopableCharts r = design(mesh, options);
    EXPECT_TRUE(r.bounds_kept);
    EXPECT_LE(r.linf_stretch, 1.05);
}

TEST(DevelopableCharts, OptionsOutOfRangeAreRefused) {
    const Mesh mesh = checks::gated(shapes::tetrahedron());
    const auto refused = [&](auto change, const std::string& name) {
        DevelopableChartsOptions options = charts(1);
        change(options);
        EXPECT_TRUE(checks::contains(
            checks::error_of<InvalidParameter>([&] { design(mesh, options); }), name));
    };
    refused([](auto& o) { o.charts_number = -1; }, "charts_number");
    refused([](auto& o) { o.charts_number = 5; }, "charts_number");
    refused([](auto& o) { o.merge_threshold = 0.0; }, "merge_threshold");
    refused([](auto& o) { o.max_l2_stretch = 1.0; }, "max_l2_stretch");
    refused([](auto& o) { o.max_linf_stretch = 0.5; }, "max_linf_stretch");
    refused([](auto& o) { o.max_linf_stretch = std::nan(""); }, "max_linf_stretch");
    refused([](auto& o) { o.max_chart_l2_stretch = 0.5; }, "max_chart_l2_stretch");
    refused([](auto& o) { o.max_chart_l2_stretch = 1.0; }, "max_chart_l2_stretch");
}

TEST(DevelopableCharts, CanBeCancelled) {
    const Mesh mesh = checks::gated(shapes::sphere(5));
    int calls = 0;
    Progress progress([&](double, const std::string&) { return ++calls < 3; });
    EXPECT_THROW(segment_developable_charts(mesh, charts(8), progress), Cancelled);
}

} // namespace
} // namespace devseg::dcharts
