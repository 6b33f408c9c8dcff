// Loops through handles, cuts to tips, and the maps to the circle that need them.
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/handle_cutter.h"
#include "devseg/graph/min_cut.h"
#include "devseg/metrics/circle_maps.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::atlas {
namespace {

using shapes::pi;

DiskCuts cut(const Mesh& mesh, const DiskOptions& options) {
    Progress progress;
    return cut_charts_to_disks(mesh, checks::components(mesh), options, progress);
}

TEST(HandleCutter, OneLoopForEachHandleLeavesNone) {
    for (const Index handles : {0, 1, 2, 3, 5})
        for (std::uint32_t seed = 1; seed <= 4; ++seed) {
            SCOPED_TRACE(std::to_string(handles) + " handles, seed " + std::to_string(seed));
            const Mesh mesh = checks::gated(
                shapes::with_noise(shapes::slab(shapes::mask_with_holes(handles)), 0.1, seed));
            const ChartMap charts = checks::components(mesh);
            std::vector<std::uint8_t> seam = charts.seam;
            for (const Index h : cut_handles(mesh, extract_charts(mesh, charts)[0], Progress()))
                seam[h] = seam[mesh.twin[h]] = 1; // one chart: local is global
            const ChartMap cuts = make_chart_map(mesh, charts.chart, seam, true);
            EXPECT_EQ(cuts.count, 1); // it hangs together
            const checks::Topology t = checks::topology(mesh, cuts, 0);
            EXPECT_EQ(t.euler + t.loops, 2); // genus 0
            EXPECT_EQ(t.loops > 0, handles > 0);
        }
}

TEST(HandleCutter, CutsThroughTheThinPart) {
    // A tube of radius 0.3 in a ring: the loop goes around the tube and not around the ring.
    const Mesh mesh = checks::gated(shapes::torus(48, 16, 2.0, 0.3));
    double length = 0.0;
    for (const Index h :
         cut_handles(mesh, extract_charts(mesh, checks::components(mesh))[0], Progress()))
        length += mesh.edge_length(h) * mesh.unit_length;
    EXPECT_GE(length, 0.99 * 2.0 * pi * 0.3 * std::sin(pi / 16) / (pi / 16));
    EXPECT_LE(length, 1.5 * 2.0 * pi * 0.3);
}

TEST(Tips, AFingerIsCutOnceItIsLongerThanItsRim) {
    const double rim = 2.0 * 12.0 * std::sin(pi / 12.0);
    for (const double length : {0.6 * rim, 1.2 * rim}) {
        const Mesh mesh = checks::gated(shapes::finger(12, 40, 1.0, length));
        const DiskCuts cuts = cut(mesh, DiskOptions{});
        const bool is_tip = length > rim;
        EXPECT_EQ(cuts.cut_tips, is_tip ? 1 : 0);
        if (is_tip) {
            EXPECT_GE(cuts.cut_length * mesh.unit_length, length);
            EXPECT_LE(cuts.cut_length * mesh.unit_length, length + 2.0); // over the round end
        }
        EXPECT_EQ(cut(mesh, DiskOptions{false, {}, {}}).cut_tips, 0);
        const checks::Topology t = checks::topology(mesh, cuts.charts, 0);
        EXPECT_EQ(t.euler, 1);
        EXPECT_EQ(t.loops, 1);
    }
}

// A plate with a hole whose rim is drawn up to a horn.
mesh::RawMesh plate_with_horn(double height) {
    std::vector<Vec2> profile{{0.0, height}};
    for (int i = 1; i <= 20; ++i)
        profile.emplace_back(1.0, height * (1.0 - i / 20.0));
    for (int i = 1; i <= 12; ++i)
        profile.emplace_back(1.0 + i / 2.0, 0.0);
    return shapes::revolve(profile, 24);
}

TEST(Tips, HornsOnWideChartsAreCut) {
    const Mesh high = checks::gated(plate_with_horn(8.0));
    const Mesh low = checks::gated(plate_with_horn(1.5));
    EXPECT_EQ(cut(high, DiskOptions{}).cut_tips, 1);
    EXPECT_EQ(cut(low, DiskOptions{}).cut_tips, 0);
    DiskOptions paper;
    paper.tip_rule.horn_loop = 0.0; // the boundary is longer than the way to the tip
    EXPECT_EQ(cut(high, paper).cut_tips, 0);
}

TEST(CircleMaps, ADiscKeepsItsShape) {
    const Mesh mesh = checks::gated(shapes::annulus(64, 8, 0.02, 1.0));
    Progress progress;
    const DiskCuts cuts = cut(mesh, DiskOptions{false, {}, HoleRule::none()});
    EXPECT_EQ(cuts.cut_charts, 1);
    const Mesh disc = checks::gated(shapes::cone(96, 12, 1.0, 0.0));
    const std::vector<double> flat =
        metrics::circle_map_stretch(disc, checks::components(disc), progress);
    ASSERT_EQ(flat.size(), 1U);
    EXPECT_NEAR(flat[0], 1.0, 1e-9);
}

TEST(CircleMaps, AHemisphereIsStretchedAsByStereographicProjection) {
    // ρ = tan(θ/2) has the scale 1 / (1 + cos θ): L2² = ½ ∫ (1 + u)² du from 0 to 1 = 7/6.
    const Mesh mesh = checks::gated(shapes::hemisphere(128, 48));
    Progress progress;
    const std::vector<double> found =
        metrics::circle_map_stretch(mesh, checks::components(mesh), progress);
    EXPECT_NEAR(found[0], std::sqrt(7.0 / 6.0), 2e-3);
}

TEST(CircleMaps, ChartsMustBeDisks) {
    const Mesh mesh = checks::gated(shapes::torus(12, 8));
    Progress progress;
    EXPECT_THROW(metrics::circle_map_stretch(mesh, checks::components(mesh), progress),
                 NumericalFailure);
}

TEST(MinCut, GoesOnFromTheFlowThatItHas) {
    // Raising links step by step ends at the same sides as solving at once.
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        shapes::Random random(seed);
        constexpr Index nodes = 40;
        std::vector<graph::CutSide> sides(at(nodes) + 2, graph::CutSide::open);
        sides[nodes] = graph::CutSide::source;
        sides[at(nodes) + 1] = graph::CutSide::sink;
        graph::MinCut steps(sides);
        graph::MinCut once(sides);
        std::vector<Index> links;
        std::vector<double> weights;
        for (int i = 0; i < 160; ++i) {
            const Index a = random.below(nodes);
            const Index b = random.below(nodes + 2);
            if (a == b)
                continue;
            weights.push_back(random.uniform(0.1, 1.0));
            links.push_back(steps.link(a, b, 0.5 * weights.back()));
            once.link(a, b, weights.back());
        }
        steps.solve();
        for (std::size_t i = 0; i < links.size(); ++i)
            steps.raise(links[i], 0.5 * weights[i]);
        EXPECT_EQ(steps.solve(), once.solve()) << seed;
    }
}

} // namespace
} // namespace devseg::atlas
