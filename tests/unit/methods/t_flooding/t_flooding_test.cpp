#include "devseg/methods/t_flooding/t_flooding.h"

#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "devseg/base/parallel.h"
#include "devseg/methods/t_flooding/balanced_borders.h"
#include "devseg/metrics/gauss_area.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::t_flooding {
namespace {

TFloodingResult segment(const Mesh& mesh, const TFloodingOptions& options) {
    Progress progress;
    return segment_t_flooding(mesh, options, progress);
}

TFloodingOptions charts(int number) {
    TFloodingOptions options;
    options.charts_number = number;
    return options;
}

mesh::RawMesh noisy_torus() {
    return shapes::with_noise(shapes::torus(60, 36, 2.0, 0.8), 0.01, 21);
}

void expect_promises(const Mesh& mesh, const TFloodingOptions& options, const TFloodingResult& r) {
    ASSERT_EQ(r.chart.size(), mesh.faces.size());
    const Index count = static_cast<Index>(r.chart_gauss_area.size());
    EXPECT_GE(count, options.charts_number);
    const atlas::ChartMap map = atlas::make_chart_map(mesh, r.chart, {}, false);
    EXPECT_EQ(map.count, count); // as many pieces as labels
    EXPECT_TRUE(checks::is_valid(mesh, map));
    EXPECT_LE(r.rounds, options.max_iterations);
    const metrics::GaussAreas areas =
        metrics::compute_gauss_areas(mesh, options.crease_angle * shapes::pi / 180.0);
    EXPECT_EQ(r.chart_gauss_area, metrics::chart_gauss_areas(mesh, areas, r.chart, count));
    EXPECT_EQ(r.gauss_area_std, metrics::standard_deviation(r.chart_gauss_area));
    EXPECT_EQ(r.face_gauss_area, areas.face);
    EXPECT_LE(std::accumulate(r.chart_gauss_area.begin(), r.chart_gauss_area.end(), 0.0),
              r.total_gauss_area * (1.0 + 1e-12));
}

TEST(TFlooding, KeepsItsPromisesOnManyShapes) {
    const std::vector<mesh::RawMesh> all = {shapes::grid(9, 7),
                                            shapes::sphere(3),
                                            noisy_torus(),
                                            shapes::double_torus(),
                                            shapes::cube(4),
                                            shapes::tetrahedron(),
                                            shapes::moebius_strip(30, 3),
                                            shapes::plate_with_handle(),
                                            shapes::capped_cylinder(16, 6)};
    for (std::size_t i = 0; i < all.size(); ++i)
        for (const int number : {1, 2, 4})
            for (const bool straight : {false, true}) {
                SCOPED_TRACE("shape " + std::to_string(i) + ", " + std::to_string(number));
                const Mesh mesh = checks::gated(all[i]);
                TFloodingOptions options = charts(number);
                options.straighten_boundaries = straight;
                expect_promises(mesh, options, segment(mesh, options));
            }
}

TEST(TFlooding, ChartsOfASphereSweepEqualAreas) {
    const Mesh mesh = checks::gated(shapes::sphere(4));
    for (const int number : {2, 5, 12}) {
        const TFloodingResult r = segment(mesh, charts(number));
        EXPECT_LT(r.gauss_area_std, 0.1 * 4.0 * shapes::pi / number);
        EXPECT_TRUE(r.converged);
    }
}

TEST(TFlooding, OffsetsBalanceWhereTheFirstRoundDoesNot) {
    const Mesh mesh = checks::gated(noisy_torus());
    TFloodingOptions options = charts(12);
    options.straighten_boundaries = false;
    options.max_iterations = 1;
    const double first = segment(mesh, options).gauss_area_std;
    options.max_iterations = 100;
    const TFloodingResult r = segment(mesh, options);
    EXPECT_GT(r.rounds, 1);
    EXPECT_LT(r.gauss_area_std, 0.7 * first);
    EXPECT_LT(r.gauss_area_std, 0.1 * r.total_gauss_area / 12);
}

TEST(TFlooding, MoreRoundsAreNeverWorse) {
    // The best round is kept.
    const Mesh mesh = checks::gated(noisy_torus());
    TFloodingOptions options = charts(9);
    options.straighten_boundaries = false;
    double before = std::numeric_limits<double>::infinity();
    for (int rounds = 1; rounds <= 12; ++rounds) {
        options.max_iterations = rounds;
        const double now = segment(mesh, options).gauss_area_std;
        EXPECT_LE(now, before);
        before = now;
    }
}

TEST(TFlooding, BordersFollowCreases) {
    for (const mesh::RawMesh& raw : {shapes::cube(6), shapes::capped_cylinder(32, 8)}) {
        const Mesh mesh = checks::gated(raw);
        const TFloodingResult r = segment(mesh, charts(8));
        const metrics::GaussAreas areas = metrics::compute_gauss_areas(mesh, shapes::pi / 4.0);
        double all = 0.0;
        double on_border = 0.0;
        for (const HalfEdge h : mesh.all_half_edges())
            if (areas.crease[h] != 0) {
                all += mesh.edge_length(h);
                if (r.chart[h / 3] != r.chart[mesh.twin[h] / 3])
                    on_border += mesh.edge_length(h);
            }
        EXPECT_GE(on_border, 0.95 * all);
    }
}

TEST(TFlooding, BordersBecomeShortAndStayBalanced) {
    const Mesh mesh = checks::gated(noisy_torus());
    TFloodingOptions options = charts(10);
    const auto border = [&](const std::vector<Index>& chart) {
        double sum = 0.0;
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] > h && chart[h / 3] != chart[mesh.twin[h] / 3])
                sum += mesh.edge_length(h);
        return sum;
    };
    options.straighten_boundaries = false;
    const double jagged = border(segment(mesh, options).chart);
    options.straighten_boundaries = true;
    const TFloodingResult r = segment(mesh, options);
    EXPECT_LT(border(r.chart), 0.85 * jagged);
    EXPECT_LT(r.gauss_area_std, 0.1 * r.total_gauss_area / 10);
}

TEST(TFlooding, BalancingLowersItsObjective) {
    // From bands of very different width on a sphere.
    const Mesh mesh = checks::gated(shapes::sphere(4));
    std::vector<Index> chart;
    for (const Vec3& c : mesh.face_centers)
        chart.push_back(c.normalized().z() > 0.6 ? 0 : 1);
    const metrics::GaussAreas areas = metrics::compute_gauss_areas(mesh, shapes::pi / 4.0);
    const double before =
        metrics::standard_deviation(metrics::chart_gauss_areas(mesh, areas, chart, 2));
    Progress progress;
    BorderBalance options;
    options.sweeps = 30;
    balance_borders(mesh, areas, {}, options, 2, chart, progress);
    EXPECT_LT(metrics::standard_deviation(metrics::chart_gauss_areas(mesh, areas, chart, 2)),
              0.1 * before);
    const atlas::ChartMap map = atlas::make_chart_map(mesh, chart, {}, false);
    EXPECT_EQ(map.count, 2);
    for (Index c = 0; c < 2; ++c)
        EXPECT_TRUE(checks::is_sound(mesh, map, c));
}

TEST(TFlooding, EveryComponentGetsAChart) {
    mesh::RawMesh raw = shapes::sphere(2);
    for (int i = 1; i < 5; ++i)
        raw = shapes::join(raw, shapes::moved(shapes::cube(3), 0.5, Vec3(3.0 * i, 0, 0)));
    const Mesh mesh = checks::gated(raw);
    for (const int number : {1, 5, 9}) {
        const TFloodingResult r = segment(mesh, charts(number));
        EXPECT_EQ(static_cast<int>(r.chart_gauss_area.size()), std::max(number, 5));
        EXPECT_EQ(atlas::make_chart_map(mesh, r.chart, {}, false).count, std::max(number, 5));
    }
}

TEST(TFlooding, TheSameChartsForAnyNumberOfThreadsAndSize) {
    const mesh::RawMesh raw = noisy_torus();
    const TFloodingResult expected = segment(checks::gated(raw), charts(9));
    for (const int threads : {1, 2, 0}) {
        set_thread_limit(threads);
        EXPECT_EQ(segment(checks::gated(raw), charts(9)).chart, expected.chart);
    }
    set_thread_limit(0);
    const mesh::RawMesh scaled = shapes::moved(raw, 1048576.0, Vec3::Zero());
    EXPECT_EQ(segment(checks::gated(scaled), charts(9)).chart, expected.chart);
}

TEST(TFlooding, OptionsOutOfRangeAreRefused) {
    const Mesh mesh = checks::gated(shapes::cube(2)); // 48 faces
    const auto refused = [&](auto change, const char* name) {
        TFloodingOptions options = charts(4);
        change(options);
        const std::string text =
            checks::error_of<InvalidParameter>([&] { segment(mesh, options); });
        EXPECT_TRUE(checks::contains(text, name));
        EXPECT_TRUE(checks::contains(text, "expected"));
    };
    using O = TFloodingOptions;
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    refused([](O& o) { o.charts_number = 0; }, "charts_number");
    refused([](O& o) { o.charts_number = 49; }, "charts_number");
    for (const double bad : {0.0, -1.0, nan}) {
        refused([&](O& o) { o.crease_angle = bad; }, "crease_angle");
        refused([&](O& o) { o.speed_epsilon = bad; }, "speed_epsilon");
        refused([&](O& o) { o.offset_damping = bad; }, "offset_damping");
    }
    refused([](O& o) { o.crease_angle = 181.0; }, "crease_angle");
    refused([](O& o) { o.speed_power = -0.1; }, "speed_power");
    refused([](O& o) { o.speed_power = 6.1; }, "speed_power");
    refused([](O& o) { o.offset_damping = 1.1; }, "offset_damping");
    refused([](O& o) { o.max_iterations = 0; }, "max_iterations");
    refused([](O& o) { o.random_seed = -1; }, "random_seed");
}

TEST(TFlooding, Cancels) {
    const Mesh mesh = checks::gated(shapes::sphere(5));
    int calls = 0;
    Progress counting([&](double, const char*) { return ++calls > 0; });
    segment_t_flooding(mesh, charts(12), counting);
    ASSERT_GE(calls, 4); // each phase announces itself
    for (int stop = 1; stop <= 4; ++stop) {
        int seen = 0;
        Progress progress([&](double, const char*) { return ++seen < stop; });
        EXPECT_THROW(segment_t_flooding(mesh, charts(12), progress), Cancelled);
        EXPECT_EQ(seen, stop);
    }
}

} // namespace
} // namespace devseg::t_flooding
