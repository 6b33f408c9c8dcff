#include "devseg/methods/dcharts/dcharts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "devseg/base/parallel.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

using checks::contains;
using checks::error_of;

DChartsResult segment(const Mesh& mesh, const DChartsOptions& options) {
    Progress progress;
    return segment_dcharts(mesh, options, progress);
}

DChartsOptions charts(int number, double max_fitting_error = 0.2) {
    DChartsOptions options;
    options.charts_number = number;
    options.max_fitting_error = max_fitting_error;
    return options;
}

mesh::RawMesh noisy_torus() {
    return shapes::with_noise(shapes::torus(40, 24, 2.0, 0.8), 0.02, 21);
}

// What dcharts.h promises of every result.
void expect_promises(const Mesh& mesh, const DChartsOptions& options, const DChartsResult& r) {
    ASSERT_EQ(r.chart.size(), mesh.faces.size());
    const Index count = static_cast<Index>(r.proxies.size());
    EXPECT_EQ(count, options.charts_number + r.hole_charts);
    EXPECT_GE(r.rounds, 1);
    EXPECT_LE(r.rounds, options.max_iterations);
    EXPECT_TRUE(r.converged || r.rounds == options.max_iterations);
    std::set<Index> used;
    for (const Index c : r.chart) {
        ASSERT_TRUE(c >= 0 && c < count);
        used.insert(c);
    }
    EXPECT_EQ(static_cast<Index>(used.size()), count);
    // Each label in one piece: as many pieces as labels.
    const atlas::ChartMap map = atlas::make_chart_map(mesh, r.chart, {}, false);
    EXPECT_EQ(map.count, count);
    EXPECT_TRUE(checks::is_valid(mesh, map));
    // The proxies are the best ones of the final charts, and the errors are theirs.
    std::vector<metrics::NormalMoments> moments(at(count));
    for (const Face f : mesh.all_faces())
        moments[r.chart[f]].add(mesh.face_areas[f], mesh.face_normals[f]);
    for (const Face f : mesh.all_faces()) {
        const metrics::ConicProxy proxy = metrics::fit_conic(moments[r.chart[f]]);
        ASSERT_NEAR(r.fitting_error[f], proxy.fitting_error(mesh.face_normals[f]), 1e-12);
    }
}

double largest_error(const DChartsResult& r) {
    return *std::max_element(r.fitting_error.begin(), r.fitting_error.end());
}

TEST(DCharts, KeepsItsPromisesOnManyShapes) {
    const std::vector<mesh::RawMesh> all = {shapes::grid(9, 7),
                                            shapes::sphere(3),
                                            noisy_torus(),
                                            shapes::double_torus(),
                                            shapes::cube(4),
                                            shapes::tetrahedron(),
                                            shapes::moebius_strip(30, 3),
                                            shapes::plate_with_handle(),
                                            shapes::finger(12, 20, 1.0, 9.0)};
    for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE("shape " + std::to_string(i));
        const Mesh mesh = checks::gated(all[i]);
        for (const int number : {1, 2, 4})
            for (const double bound : {4.0, 0.2, 0.001}) {
                DChartsOptions options = charts(number, bound);
                options.max_iterations = 1 + static_cast<int>(i);
                expect_promises(mesh, options, segment(mesh, options));
            }
    }
}

TEST(DCharts, EveryFaceMayBeAChart) {
    const Mesh mesh = checks::gated(shapes::sphere(1));
    const DChartsResult r = segment(mesh, charts(mesh.face_count()));
    expect_promises(mesh, charts(mesh.face_count()), r);
    EXPECT_LT(largest_error(r), 1e-12);
}

TEST(DCharts, ACappedCylinderFallsIntoItsThreeParts) {
    // Where triangles are about as wide as high; Lloyd rounds may end elsewhere on slivers.
    for (const auto& [around, along, height] :
         {std::tuple(16, 4, 2.0), {24, 4, 2.0}, {32, 4, 2.0}, {16, 8, 4.0}, {24, 8, 4.0}}) {
        const Mesh mesh = checks::gated(shapes::capped_cylinder(around, along, 1.0, height));
        const DChartsResult r = segment(mesh, charts(3));
        EXPECT_EQ(r.hole_charts, 0);
        EXPECT_LT(largest_error(r), 1e-12);
        std::map<Index, std::set<int>> parts; // label → the parts of the shape that it covers
        for (const Face f : mesh.all_faces())
            parts[r.chart[f]].insert(static_cast<int>(std::lround(mesh.face_normals[f].z())));
        ASSERT_EQ(parts.size(), 3U);
        std::set<int> covered;
        for (const auto& [label, part] : parts) {
            EXPECT_EQ(part.size(), 1U) << "a chart reaches over a sharp edge";
            covered.insert(part.begin(), part.end());
        }
        EXPECT_EQ(covered, (std::set<int>{-1, 0, 1}));
    }
}

TEST(DCharts, CappedCylindersOfAnyProportionsGetDevelopableCharts) {
    for (const Index around : {16, 24, 48})
        for (const Index along : {2, 8, 12})
            for (const double height : {1.0, 4.0}) {
                const Mesh mesh =
                    checks::gated(shapes::capped_cylinder(around, along, 1.0, height));
                const DChartsResult r = segment(mesh, charts(3));
                EXPECT_LT(largest_error(r), 0.03); // a seventh of the bound
                EXPECT_LE(r.proxies.size(), 5U);
            }
}

TEST(DCharts, ACubeIsCutIntoDevelopableCharts) {
    const Mesh mesh = checks::gated(shapes::cube(6));
    for (int number = 3; number <= 6; ++number) {
        const DChartsResult r = segment(mesh, charts(number, 0.01));
        EXPECT_LT(largest_error(r), 1e-12) << number; // cones and cylinders over whole sides
        EXPECT_GE(r.proxies.size(), 3U);
        EXPECT_LE(r.proxies.size(), 6U);
    }
}

TEST(DCharts, ASmallerBoundMakesChartsThatFitBetter) {
    const Mesh mesh = checks::gated(shapes::sphere(4));
    const auto mean = [&](double bound) {
        const DChartsResult r = segment(mesh, charts(8, bound));
        double sum = 0.0;
        for (const Face f : mesh.all_faces())
            sum += mesh.face_areas[f] * r.fitting_error[f];
        return sum / mesh.total_area;
    };
    EXPECT_LT(mean(0.005), 0.5 * mean(0.2));
}

TEST(DCharts, ConvergedMeansThatFewFacesChanged) {
    // Without holes, the charts of n rounds are those of round n.
    const Mesh mesh = checks::gated(noisy_torus());
    DChartsOptions options = charts(8, 4.0);
    const int rounds = segment(mesh, options).rounds;
    EXPECT_GE(rounds, 3);
    std::vector<Index> before;
    for (int n = 1; n <= rounds; ++n) {
        options.max_iterations = n;
        const DChartsResult r = segment(mesh, options);
        EXPECT_EQ(r.rounds, n);
        std::size_t changed = r.chart.size();
        if (!before.empty()) {
            changed = 0;
            for (std::size_t f = 0; f < before.size(); ++f)
                changed += before[f] != r.chart[f] ? 1U : 0U;
        }
        EXPECT_EQ(r.converged, 20 * changed < r.chart.size());
        EXPECT_EQ(r.converged, n == rounds);
        before = r.chart;
    }
}

TEST(DCharts, LargeHolesGetChartsOfTheirOwn) {
    // A strict bound leaves most of a sphere to hole filling.
    const Mesh mesh = checks::gated(shapes::sphere(3));
    const DChartsResult r = segment(mesh, charts(2, 0.002));
    EXPECT_GT(r.hole_charts, 0);
    expect_promises(mesh, charts(2, 0.002), r);
}

TEST(DCharts, ComponentsAreNeverJoined) {
    const mesh::RawMesh raw =
        shapes::join(shapes::sphere(2), shapes::moved(shapes::cube(3), 0.5, Vec3(4, 0, 0)));
    const Mesh mesh = checks::gated(raw);
    for (const int number : {1, 2, 5}) { // one seed for two components: the other is a hole
        const DChartsResult r = segment(mesh, charts(number));
        expect_promises(mesh, charts(number), r);
        std::set<Index> on_sphere(r.chart.begin(), r.chart.begin() + 320);
        for (std::size_t f = 320; f < r.chart.size(); ++f)
            ASSERT_EQ(on_sphere.count(r.chart[f]), 0U);
        EXPECT_EQ(r.hole_charts > 0 || number > 1, true);
    }
}

TEST(DCharts, TheSameInputGivesTheSameChartsOnAnyNumberOfThreads) {
    const Mesh mesh = checks::gated(noisy_torus());
    const DChartsResult first = segment(mesh, charts(9));
    for (const int threads : {1, 2, 0}) {
        set_thread_limit(threads);
        const DChartsResult again = segment(mesh, charts(9));
        EXPECT_EQ(again.chart, first.chart);
        EXPECT_EQ(again.fitting_error, first.fitting_error);
        EXPECT_EQ(again.rounds, first.rounds);
    }
    set_thread_limit(0);
}

void expect_same_charts_in_any_face_order(const DChartsOptions& options) {
    const mesh::RawMesh raw = noisy_torus();
    const DChartsResult expected = segment(checks::gated(raw), options);
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const std::vector<Index> order = shapes::random_order(raw.faces.size(), seed);
        const Mesh shuffled = checks::gated(shapes::with_face_order(raw, order));
        const DChartsResult r = segment(shuffled, options);
        std::map<Index, Index> renamed;
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Index label = expected.chart[order[i]];
            ASSERT_EQ(renamed.try_emplace(r.chart[i], label).first->second, label);
        }
        EXPECT_EQ(renamed.size(), expected.proxies.size());
    }
}

TEST(DCharts, TheOrderOfFacesDoesNotMatter) {
    expect_same_charts_in_any_face_order(charts(9));
}

TEST(DCharts, SizeAndPlaceDoNotMatter) {
    const mesh::RawMesh raw = noisy_torus();
    const std::vector<Index> expected = segment(checks::gated(raw), charts(7)).chart;
    for (const double scale : {1e-9, 1e9})
        EXPECT_EQ(
            segment(checks::gated(shapes::moved(raw, scale, Vec3(scale, 0, 0))), charts(7)).chart,
            expected);
}

TEST(DCharts, WeightsOfZeroAndTenAreAccepted) {
    const Mesh mesh = checks::gated(noisy_torus());
    for (const double weight : {0.0, 10.0}) {
        DChartsOptions options = charts(6);
        options.alpha = options.beta = options.gamma = weight;
        expect_promises(mesh, options, segment(mesh, options));
    }
}

TEST(DCharts, FacesWithoutAreaAreLabelledAsWell) {
    mesh::RawMesh raw = shapes::grid(6, 6);
    for (Index i = 8; i < 13; ++i)
        raw.points[i] = raw.points[i - 7]; // a whole row collapses
    const Mesh mesh = mesh::gate_mesh(raw, {-1.0, false}).mesh;
    expect_promises(mesh, charts(3), segment(mesh, charts(3)));
}

TEST(DCharts, OptionsOutOfRangeAreRefusedWithTheirRange) {
    const Mesh mesh = checks::gated(shapes::cube(2)); // 48 faces
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto refusal = [&](auto change, const char* name, const char* range, const char* found) {
        DChartsOptions options = charts(4);
        change(options);
        const std::string text = error_of<InvalidParameter>([&] { segment(mesh, options); });
        EXPECT_TRUE(contains(text, name));
        EXPECT_TRUE(contains(text, range));
        EXPECT_TRUE(contains(text, std::string("found ") + found));
    };
    using O = DChartsOptions;
    for (const auto& [value, text] : {std::pair(0, "0"), {-3, "-3"}, {49, "49"}})
        refusal([v = value](O& o) { o.charts_number = v; }, "charts_number", "from 1 to 48", text);
    for (const auto& [value, text] :
         {std::pair(0.0, "0"), {-1.0, "-1"}, {4.5, "4.5"}, {nan, "nan"}, {infinity, "inf"}})
        refusal([v = value](O& o) { o.max_fitting_error = v; }, "max_fitting_error",
                "above 0 and at most 4", text);
    for (const auto& [value, text] :
         {std::pair(-0.5, "-0.5"), {10.5, "10.5"}, {nan, "nan"}, {infinity, "inf"}}) {
        refusal([v = value](O& o) { o.alpha = v; }, "alpha", "from 0 to 10", text);
        refusal([v = value](O& o) { o.beta = v; }, "beta", "from 0 to 10", text);
        refusal([v = value](O& o) { o.gamma = v; }, "gamma", "from 0 to 10", text);
    }
    refusal([](O& o) { o.max_iterations = 0; }, "max_iterations", "at least 1", "0");
    refusal([](O& o) { o.random_seed = -1; }, "random_seed", "at least 0", "-1");
}

TEST(DCharts, CancelsAtAnyCallback) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::sphere(5), 0.01, 4));
    int calls = 0;
    Progress counting([&](double, const char*) { return ++calls > 0; });
    segment_dcharts(mesh, charts(12), counting);
    ASSERT_GE(calls, 3); // each phase announces itself
    shapes::Random random(3);
    for (const int stop : {1, 2, 3, 1 + random.below(calls), 1 + random.below(calls)}) {
        int seen = 0;
        Progress progress([&](double, const char*) { return ++seen < stop; });
        try {
            segment_dcharts(mesh, charts(12), progress);
            EXPECT_LT(seen, stop); // a faster run has fewer callbacks
        } catch (const Cancelled&) {
            EXPECT_EQ(seen, stop); // and none after the answer to stop
        }
    }
}

} // namespace
} // namespace devseg::dcharts
