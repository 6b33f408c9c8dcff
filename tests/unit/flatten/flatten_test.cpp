#include "devseg/flatten/flatten.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "devseg/base/parallel.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/methods/dcharts/dcharts.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

constexpr FlattenMethod methods[] = {FlattenMethod::symmetric_dirichlet, FlattenMethod::lscm};

FlattenResult flatten(const Mesh& mesh, const atlas::ChartMap& charts, FlattenMethod method) {
    Progress progress;
    return flatten_charts(mesh, charts, method, progress);
}

atlas::ChartMap segmented(const Mesh& mesh, int number) {
    Progress progress;
    dcharts::DChartsOptions options;
    options.charts_number = number;
    const dcharts::DChartsResult r = dcharts::segment_dcharts(mesh, options, progress);
    return atlas::cut_charts_to_disks(mesh, atlas::make_chart_map(mesh, r.chart, {}, false),
                                      progress)
        .charts;
}

// Pairs of faces of one chart that share more than a sliver of area, by clipping.
Index overlaps(const FlatChart& chart) {
    const auto corners = [&](std::size_t f) {
        const Triangle& t = chart.surface.faces[f];
        return checks::Corners{chart.uv[t[0]], chart.uv[t[1]], chart.uv[t[2]]};
    };
    Index count = 0;
    for (std::size_t f = 0; f < chart.surface.faces.size(); ++f)
        for (std::size_t g = f + 1; g < chart.surface.faces.size(); ++g)
            count += checks::common_area(corners(f), corners(g)) > 1e-8 ? 1 : 0;
    return count;
}

// What flatten.h promises.
void expect_promises(const Mesh& mesh, const atlas::ChartMap& charts, const FlattenResult& r) {
    EXPECT_TRUE(checks::is_valid(mesh, r.charts));
    ASSERT_EQ(static_cast<Index>(r.flat.size()), r.charts.count);
    for (std::size_t h = 0; h < charts.seam.size(); ++h)
        ASSERT_GE(r.charts.seam[h], charts.seam[h]); // cuts are only added
    if (r.cuts == 0) {
        EXPECT_EQ(r.charts.seam, charts.seam);
        EXPECT_EQ(r.charts.chart, charts.chart);
    }
    for (Index c = 0; c < r.charts.count; ++c) {
        const FlatChart& chart = r.flat[c];
        ASSERT_EQ(chart.uv.size(), chart.surface.vertex.size());
        double area = 0.0;
        double flat = 0.0;
        for (const Face f : chart.surface.all_faces()) {
            ASSERT_EQ(r.charts.chart[chart.surface.face[f]], c);
            area += mesh.face_areas[chart.surface.face[f]];
            const Triangle& t = chart.surface.faces[f];
            flat += 0.5 * orientation(chart.uv[t[0]], chart.uv[t[1]], chart.uv[t[2]]);
        }
        EXPECT_EQ(checks::count_flips(chart.surface.faces, chart.uv), 0);
        EXPECT_NEAR(flat, area, 2e-3 * area); // opening closed slits may cost a little
        EXPECT_GE(chart.energy, 1.0 - 1e-9);
        EXPECT_EQ(overlaps(chart), 0);
    }
}

TEST(Flatten, KeepsItsPromises) {
    for (const mesh::RawMesh& raw :
         {shapes::sphere(2), shapes::torus(16, 10), shapes::cube(3), shapes::double_torus(),
          shapes::plate_with_handle(), shapes::capped_cylinder(16, 4),
          shapes::with_noise(shapes::sphere(2), 0.05, 3), shapes::moebius_strip(20, 2)}) {
        const Mesh mesh = checks::gated(raw);
        for (const atlas::ChartMap& charts :
             {checks::components_cut_to_disks(mesh), segmented(mesh, 4)})
            for (const FlattenMethod method : methods)
                expect_promises(mesh, charts, flatten(mesh, charts, method));
    }
}

TEST(Flatten, DevelopableChartsAreIsometric) {
    const mesh::RawMesh raw = shapes::join(
        shapes::join(shapes::grid(4, 3), shapes::moved(shapes::cylinder_tube(16, 4), 1, {5, 0, 0})),
        shapes::moved(shapes::frustum(16, 3, 1.0, 0.4, 1.0), 1, {10, 0, 0}));
    const Mesh mesh = checks::gated(raw);
    const atlas::ChartMap charts = checks::components_cut_to_disks(mesh);
    for (const FlattenMethod method : methods) {
        const FlattenResult r = flatten(mesh, charts, method);
        ASSERT_EQ(r.flat.size(), 3U);
        for (const FlatChart& chart : r.flat) {
            EXPECT_NEAR(chart.energy, 1.0, 1e-9);
            EXPECT_TRUE(chart.converged);
            EXPECT_FALSE(chart.mended);
            EXPECT_FALSE(chart.pushed);
        }
        EXPECT_EQ(r.cuts, 0);
    }
}

TEST(Flatten, TheMethodDecidesWhatIsKept) {
    const Mesh mesh = checks::gated(shapes::hemisphere(20, 10));
    const atlas::ChartMap charts = checks::components_cut_to_disks(mesh);
    const FlatChart isometric =
        flatten(mesh, charts, FlattenMethod::symmetric_dirichlet).flat.at(0);
    const FlatChart conformal = flatten(mesh, charts, FlattenMethod::lscm).flat.at(0);
    const FlatteningProblem problem = make_flattening_problem(mesh, isometric.surface);
    EXPECT_FALSE(conformal.mended);
    EXPECT_LT(isometric.energy, conformal.energy - 0.01);
    EXPECT_LT(conformal_energy(problem, conformal.uv),
              0.5 * conformal_energy(problem, isometric.uv));
}

TEST(Flatten, ChartsOnWhichLscmFlipsAreMended) {
    for (const auto& [raw, expected] :
         {std::pair(shapes::with_noise(shapes::grid(12, 12), 0.1, 4), true),
          {shapes::finger(8, 60, 1.0, 47.0), true}, // shrinks below rounding
          {shapes::hemisphere(20, 8), false}}) {
        const Mesh mesh = checks::gated(raw);
        const atlas::ChartMap charts = checks::components(mesh);
        const FlatteningProblem problem =
            make_flattening_problem(mesh, atlas::extract_charts(mesh, charts).at(0));
        ASSERT_EQ(checks::count_flips(problem.faces, flatten_lscm(problem)) > 0, expected);
        const FlattenResult r = flatten(mesh, charts, FlattenMethod::lscm);
        expect_promises(mesh, charts, r);
        EXPECT_EQ(r.flat.at(0).mended, expected);
        EXPECT_FALSE(flatten(mesh, charts, FlattenMethod::symmetric_dirichlet).flat.at(0).mended);
    }
}

TEST(Flatten, PartsThatWouldOverlapComeApart) {
    for (const double turns : {1.3, 2.2}) {
        const Mesh mesh = checks::gated(shapes::helix_strip(120, turns, 1.0, 2.0, 0.3));
        const atlas::ChartMap charts = checks::components(mesh);
        for (const FlattenMethod method : methods) {
            const FlattenResult r = flatten(mesh, charts, method);
            expect_promises(mesh, charts, r);
            EXPECT_TRUE(r.cuts > 0 || r.flat.at(0).pushed);
        }
    }
}

TEST(Flatten, TheNumberOfThreadsDoesNotMatter) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::torus(30, 16), 0.03, 6));
    const atlas::ChartMap charts = segmented(mesh, 7);
    const auto flat = [&](int threads) {
        set_thread_limit(threads);
        const FlattenResult r = flatten(mesh, charts, FlattenMethod::symmetric_dirichlet);
        set_thread_limit(0);
        std::vector<Vec2> all;
        for (const FlatChart& chart : r.flat)
            all.insert(all.end(), chart.uv.begin(), chart.uv.end());
        return all;
    };
    const std::vector<Vec2> first = flat(1);
    for (const int threads : {1, 2, 3, 8})
        EXPECT_EQ(flat(threads), first); // the same bytes
}

TEST(Flatten, SizeAndPlaceDoNotMatter) {
    const mesh::RawMesh raw = shapes::with_noise(shapes::hemisphere(16, 6), 0.02, 5);
    const auto energy = [&](double scale, const Vec3& place) {
        const Mesh mesh = checks::gated(shapes::moved(raw, scale, place));
        const atlas::ChartMap charts = checks::components_cut_to_disks(mesh);
        return flatten(mesh, charts, FlattenMethod::symmetric_dirichlet).flat.at(0).energy;
    };
    const double reference = energy(1.0, Vec3::Zero());
    EXPECT_NEAR(energy(1e-9, Vec3::Zero()), reference, 1e-6);
    EXPECT_NEAR(energy(1e9, Vec3(1e10, 0.0, 0.0)), reference, 1e-6);
}

TEST(Flatten, ChartsThatAreNoDisksAreRefused) {
    const Mesh mesh = checks::gated(shapes::torus(8, 6));
    EXPECT_TRUE(checks::contains(checks::error_of<NumericalFailure>([&] {
                                     flatten(mesh, checks::components(mesh),
                                             FlattenMethod::symmetric_dirichlet);
                                 }),
                                 "Charts: Cut to Disks"));
}

TEST(Flatten, HardChartsEndInAMapOrAClearFailure) {
    // Fingers so long that distances in Tutte's map shrink towards the end of all precision.
    for (const Index rings : {60, 120, 400})
        for (const FlattenMethod method : methods) {
            const Mesh mesh = checks::gated(shapes::finger(6, rings, 1.0, rings));
            const atlas::ChartMap charts = checks::components(mesh);
            try {
                expect_promises(mesh, charts, flatten(mesh, charts, method));
            } catch (const NumericalFailure& error) {
                EXPECT_TRUE(checks::contains(error.what(), std::to_string(mesh.face_count())));
                EXPECT_TRUE(checks::contains(error.what(), "without flipped faces"));
            }
        }
}

// A tube that is closed at one end is a disk, and so it is not cut; it should still be flattened.
TEST(Flatten, LongClosedTubesAreFlattened) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::finger(6, 60, 1.0, 60.0), 0.02, 3));
    const atlas::ChartMap charts = checks::components_cut_to_disks(mesh);
    expect_promises(mesh, charts, flatten(mesh, charts, FlattenMethod::symmetric_dirichlet));
}

TEST(Flatten, Cancels) {
    const Mesh mesh = checks::gated(shapes::sphere(5));
    const atlas::ChartMap charts = segmented(mesh, 6);
    for (const int stop : {1, 2, 4}) {
        int calls = 0;
        Progress progress([&](double, const char*) { return ++calls < stop; });
        try {
            flatten_charts(mesh, charts, FlattenMethod::symmetric_dirichlet, progress);
            EXPECT_LT(calls, stop); // a faster run has fewer callbacks
        } catch (const Cancelled&) {
            EXPECT_EQ(calls, stop);
        }
        EXPECT_GE(calls, 1);
    }
}

} // namespace
} // namespace devseg::flatten
