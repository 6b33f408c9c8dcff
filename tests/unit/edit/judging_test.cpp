// Large charts are judged on a coarse version of themselves: the same verdict, nearly the same
// stretch.
#include "devseg/edit/judging.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "devseg/flatten/flatten.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::edit {
namespace {

using judge::TrialMap;
using judge::WholeEffort;

std::vector<std::uint8_t> no_seams(const Mesh& mesh) {
    return std::vector<std::uint8_t>(mesh.twin.size(), 0);
}

std::vector<Index> all_faces(const Mesh& mesh) {
    std::vector<Index> faces(mesh.faces.size());
    std::iota(faces.begin(), faces.end(), 0);
    return faces;
}

struct Both {
    TrialMap quick;
    TrialMap whole;
};

Both judged(const mesh::RawMesh& raw, const WholeEffort& effort) {
    const Mesh mesh = checks::gated(raw);
    Progress progress;
    const auto faces = std::vector<std::vector<Index>>{all_faces(mesh)};
    return {quick_maps(mesh, faces, no_seams(mesh), effort, progress).maps.front(),
            judge::whole_maps(mesh, faces, no_seams(mesh), effort, progress).front()};
}

void expect_alike(const Both& maps) {
    EXPECT_EQ(maps.quick.flat, maps.whole.flat);
    EXPECT_NEAR(std::sqrt(maps.quick.l2_squared), std::sqrt(maps.whole.l2_squared), 5e-4);
    EXPECT_NEAR(maps.quick.area, maps.whole.area, 1e-9 * maps.whole.area);
}

// A plate with a round hill in its middle, of 20,000 faces.
mesh::RawMesh hill() {
    mesh::RawMesh raw = shapes::grid(100, 100, 2.0, 2.0);
    for (Vec3& p : raw.points)
        p.z() = 0.4 * std::exp(-6.0 * (p - Vec3(1.0, 1.0, 0.0)).squaredNorm());
    return raw;
}

TEST(QuickMaps, OfALargeChartAreNearThoseOfAllItsFaces) {
    const Both maps = judged(hill(), {1.05});
    EXPECT_TRUE(maps.quick.flat);
    EXPECT_GT(maps.quick.l2_squared, 1.005);
    EXPECT_TRUE(maps.quick.turns.empty()); // those would be of other faces
    expect_alike(maps);
}

TEST(QuickMaps, SeeThatALargeChartLiesOnItself) {
    for (const bool push_apart : {true, false}) {
        const Both maps = judged(shapes::ramp(), {1.05, push_apart});
        EXPECT_FALSE(maps.quick.flat);
        expect_alike(maps);
    }
}

TEST(QuickMaps, OfSmallChartsAreTheWholeOnesAndAllKeepTheirOrder) {
    const Mesh mesh = checks::gated(hill());
    std::vector<std::vector<Index>> charts(4);
    std::vector<std::uint8_t> seam = no_seams(mesh);
    const auto chart_of = [&](Face f) {
        const double x = mesh.face_centers[f].x() - mesh.points[Vertex(0)].x();
        const double width = 2.0 / mesh.unit_length;
        return at(static_cast<Index>(x < 0.1 * width    ? 0
                                     : x < 0.55 * width ? 1
                                     : x < 0.9 * width  ? 2
                                                        : 3));
    };
    for (const Face f : mesh.all_faces())
        charts[chart_of(f)].push_back(f);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0)
            seam[h] = chart_of(face_of(h)) != chart_of(mesh.across(h)) ? 1 : 0;
    Progress progress;
    const std::vector<TrialMap> whole = judge::whole_maps(mesh, charts, seam, {}, progress);
    const std::vector<TrialMap> quick = quick_maps(mesh, charts, seam, {}, progress).maps;
    ASSERT_EQ(quick.size(), charts.size());
    for (std::size_t c = 0; c < charts.size(); ++c) {
        const bool is_small = charts[c].size() < 8000;
        EXPECT_EQ(quick[c].l2_squared == whole[c].l2_squared, is_small) << charts[c].size();
        expect_alike({quick[c], whole[c]});
        EXPECT_EQ(is_small, c != 1);
    }
}

TEST(QuickMaps, WhatTheyTakeIsConfirmedOnAllFaces) {
    const Mesh mesh = checks::gated(hill());
    Progress progress;
    const WholeEffort effort;
    const auto faces = std::vector<std::vector<Index>>{all_faces(mesh)};
    QuickMaps quick = quick_maps(mesh, faces, no_seams(mesh), effort, progress);
    const double coarse = quick.maps.front().l2_squared;
    const TrialMap whole = judge::whole_maps(mesh, faces, no_seams(mesh), effort, progress).front();
    confirm_maps(mesh, faces, no_seams(mesh), effort, quick, progress);
    const TrialMap& fine = quick.maps.front();
    EXPECT_TRUE(fine.flat);
    EXPECT_LT(std::abs(fine.l2_squared - whole.l2_squared),
              0.5 * std::abs(coarse - whole.l2_squared));
    EXPECT_NEAR(fine.linf, whole.linf, 0.05);
    EXPECT_NEAR(fine.area, whole.area, 1e-9 * whole.area);
}

TEST(QuickMaps, WhatIsTooMuchOnAllFacesIsNotConfirmed) {
    const Mesh mesh = checks::gated(hill());
    Progress progress;
    const auto faces = std::vector<std::vector<Index>>{all_faces(mesh)};
    const TrialMap whole = judge::whole_maps(mesh, faces, no_seams(mesh), {}, progress).front();
    QuickMaps quick = quick_maps(mesh, faces, no_seams(mesh), {}, progress);
    // Another bound than before: the refined map is above it, and the answer is the best map.
    const WholeEffort strict{std::sqrt(whole.l2_squared) - 1e-3};
    confirm_maps(mesh, faces, no_seams(mesh), strict, quick, progress);
    EXPECT_EQ(quick.maps.front().l2_squared, whole.l2_squared);
}

// All faces do not come apart: flattening tries fewer of them as well.
TEST(QuickMaps, WhatIsPushedApartIsLeftInOnePieceByFlattening) {
    const Mesh mesh = checks::gated(shapes::ramp(1.07, 0.02));
    Progress progress;
    const auto faces = std::vector<std::vector<Index>>{all_faces(mesh)};
    QuickMaps quick = quick_maps(mesh, faces, no_seams(mesh), {}, progress);
    ASSERT_TRUE(quick.coarse.front() && quick.coarse.front()->map.flat.pushed);
    confirm_maps(mesh, faces, no_seams(mesh), {}, quick, progress);
    EXPECT_TRUE(quick.maps.front().flat);
    const atlas::ChartMap one =
        atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), {}, false);
    const auto flat =
        flatten::flatten_charts(mesh, one, flatten::FlattenMethod::symmetric_dirichlet, progress);
    EXPECT_EQ(flat.cuts, 0);
}

} // namespace
} // namespace devseg::edit
