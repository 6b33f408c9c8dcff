#include "devseg/atlas/charts.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "devseg/atlas/texture.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::atlas {
namespace {

using checks::is_valid;

std::vector<Index> zeros(const Mesh& mesh) {
    return std::vector<Index>(mesh.faces.size(), 0);
}

// Marks the edges (both half-edges) of which `cut(midpoint, direction)` holds.
template <class Cut>
std::vector<std::uint8_t> seams_where(const Mesh& mesh, Cut cut) {
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Vec3& a = mesh.points[mesh.origin(h)];
        const Vec3& b = mesh.points[mesh.target(h)];
        seam[h] = cut(Vec3(0.5 * (a + b)), Vec3(b - a)) ? 1 : 0;
    }
    return seam;
}

// A grid of 8 × 8 over [−½, ½]² internal units: edges along x = 0.
std::vector<std::uint8_t> slit(const Mesh& mesh, double from, double to) {
    return seams_where(mesh, [&](const Vec3& middle, const Vec3& direction) {
        return std::abs(direction.x()) < 1e-9 && std::abs(middle.x()) < 1e-9 && middle.y() > from &&
               middle.y() < to;
    });
}

void expect_local_manifold(const Mesh& mesh, const ChartSurface& s) {
    for (const HalfEdge h : s.all_half_edges()) {
        ASSERT_EQ(s.vertex[s.origin(h)], mesh.origin(s.mesh_half_edge(h)));
        const Index opposite = s.twin[h];
        if (opposite < 0)
            continue;
        ASSERT_EQ(s.twin[opposite], h);
        ASSERT_EQ(s.mesh_half_edge(opposite), mesh.twin[s.mesh_half_edge(h)]);
        ASSERT_EQ(s.origin(h), s.target(opposite));
        ASSERT_EQ(s.target(h), s.origin(opposite));
    }
    std::set<Index> on_loops;
    for (const std::vector<Index>& loop : s.loops)
        for (std::size_t i = 0; i < loop.size(); ++i) {
            ASSERT_LT(s.twin[loop[i]], 0);
            ASSERT_EQ(s.target(loop[i]), s.origin(loop[(i + 1) % loop.size()]));
            ASSERT_TRUE(on_loops.insert(loop[i]).second) << "twice on a loop";
        }
    ASSERT_EQ(static_cast<Index>(on_loops.size()),
              static_cast<Index>(std::count(s.twin.begin(), s.twin.end(), -1)));
}

TEST(Charts, TopologyOfKnownShapes) {
    struct Known {
        const char* name;
        mesh::RawMesh raw;
        Index euler;
        Index loops;
    };
    const std::vector<Known> known = {
        {"grid", shapes::grid(3, 4), 1, 1},
        {"tube", shapes::cylinder_tube(7, 3), 0, 2},
        {"cone", shapes::cone(9, 3), 1, 1},
        {"hemisphere", shapes::hemisphere(9, 4), 1, 1},
        {"sphere", shapes::sphere(2), 2, 0},
        {"tetrahedron", shapes::tetrahedron(), 2, 0},
        {"cube", shapes::cube(3), 2, 0},
        {"torus", shapes::torus(9, 7), 0, 0},
        {"double torus", shapes::double_torus(), -2, 0},
        {"annulus", shapes::annulus(9, 2, 1.0, 2.0), 0, 2},
        {"plate with 3 holes", shapes::plate(shapes::mask_with_holes(3)), -2, 4},
        {"slab with 4 holes", shapes::slab(shapes::mask_with_holes(4)), -6, 0},
        {"plate with a handle", shapes::plate_with_handle(), -3, 3},
        {"Möbius strip, cut", shapes::moebius_strip(16), 1, 1},
    };
    for (const Known& shape : known) {
        SCOPED_TRACE(shape.name);
        const Mesh mesh = checks::gated(shape.raw);
        const ChartMap charts = checks::components(mesh);
        EXPECT_TRUE(is_valid(mesh, charts));
        ASSERT_EQ(charts.count, 1);
        const ChartSurface surface = extract_charts(mesh, charts).at(0);
        expect_local_manifold(mesh, surface);
        EXPECT_EQ(surface.euler_characteristic(), shape.euler);
        EXPECT_EQ(static_cast<Index>(surface.loops.size()), shape.loops);
        EXPECT_EQ(surface.is_disk(), shape.euler == 1 && shape.loops == 1);
        EXPECT_EQ(checks::topology(mesh, charts, 0).euler, shape.euler);
        EXPECT_EQ(checks::topology(mesh, charts, 0).loops, shape.loops);
    }
}

TEST(Charts, LabelsAreMadeContiguousInTheOrderOfTheirFirstFace) {
    const Mesh mesh = checks::gated(shapes::grid(3, 1));
    const ChartMap charts = make_chart_map(mesh, {7, 7, -3, -3, 40, 40}, {}, false);
    EXPECT_EQ(charts.chart, (std::vector<Index>{0, 0, 1, 1, 2, 2}));
    EXPECT_EQ(charts.count, 3);
    EXPECT_TRUE(is_valid(mesh, charts));
}

TEST(Charts, LabelsInSeveralPlacesBecomeSeveralCharts) {
    const Mesh mesh = checks::gated(shapes::grid(3, 1));
    const ChartMap charts = make_chart_map(mesh, {5, 5, 1, 1, 5, 5}, {}, false);
    EXPECT_EQ(charts.chart, (std::vector<Index>{0, 0, 1, 1, 2, 2}));
}

TEST(Charts, RandomLabelsGiveValidCharts) {
    const Mesh mesh = checks::gated(shapes::sphere(2));
    for (std::uint32_t seed = 1; seed < 30; ++seed) {
        shapes::Random random(seed);
        std::vector<Index> labels;
        for (std::size_t f = 0; f < mesh.faces.size(); ++f)
            labels.push_back(random.below(3));
        const ChartMap charts = make_chart_map(mesh, labels, {}, false);
        ASSERT_TRUE(is_valid(mesh, charts));
        // Maximal: charts of equal labels never touch along an edge, and no other edge is cut.
        for (const HalfEdge h : mesh.all_half_edges()) {
            const Index opposite = mesh.twin[h];
            ASSERT_EQ(charts.seam[h] == 0, labels[h / 3] == labels[opposite / 3]);
        }
        Index faces = 0;
        for (const ChartSurface& surface : extract_charts(mesh, charts)) {
            expect_local_manifold(mesh, surface);
            faces += surface.face_count();
            const Index chart = charts.chart[surface.face.front()];
            const checks::Topology expected = checks::topology(mesh, charts, chart);
            ASSERT_EQ(surface.euler_characteristic(), expected.euler);
            ASSERT_EQ(static_cast<Index>(surface.loops.size()), expected.loops);
        }
        ASSERT_EQ(faces, mesh.face_count());
    }
}

TEST(Charts, GroupsHoldEachFaceOnceInAscendingOrder) {
    const Mesh mesh = checks::gated(shapes::grid(4, 4));
    const ChartMap charts = make_chart_map(mesh, shapes::random_order(32, 3), {}, false);
    const Buckets<Index> groups = group_faces(charts);
    ASSERT_EQ(groups.count(), charts.count);
    ASSERT_EQ(groups.items.size(), mesh.faces.size());
    for (Index c = 0; c < charts.count; ++c) {
        EXPECT_TRUE(std::is_sorted(groups[c].begin(), groups[c].end()));
        for (const Index f : groups[c])
            EXPECT_EQ(charts.chart[f], c);
    }
}

TEST(Charts, ASlitFromTheBorderKeepsADisk) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    const ChartMap charts = make_chart_map(mesh, zeros(mesh), slit(mesh, -1.0, 0.0), true);
    EXPECT_TRUE(is_valid(mesh, charts));
    const ChartSurface surface = extract_charts(mesh, charts).at(0);
    expect_local_manifold(mesh, surface);
    EXPECT_TRUE(surface.is_disk());
    EXPECT_EQ(surface.loops.at(0).size(), 32U + 8U); // four edges, each from both sides
    EXPECT_EQ(surface.vertex_count(), mesh.vertex_count() + 4);
}

TEST(Charts, ASlitInsideIsALoop) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    const ChartMap charts = make_chart_map(mesh, zeros(mesh), slit(mesh, -0.3, 0.3), true);
    const ChartSurface surface = extract_charts(mesh, charts).at(0);
    EXPECT_EQ(surface.loops.size(), 2U);
    EXPECT_EQ(surface.euler_characteristic(), 0);
    EXPECT_FALSE(surface.is_disk());
}

TEST(Charts, ASlitAcrossSplitsOnlyWhereItMay) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    const std::vector<std::uint8_t> across = slit(mesh, -1.0, 1.0);
    const ChartMap split = make_chart_map(mesh, zeros(mesh), across, true);
    EXPECT_EQ(split.count, 2);
    EXPECT_TRUE(is_valid(mesh, split));
    const ChartMap whole = make_chart_map(mesh, zeros(mesh), across, false);
    EXPECT_EQ(whole.count, 1);
    EXPECT_EQ(whole.seam, split.seam);
}

TEST(Charts, ASeamOnOneSideOfAnEdgeCountsForBoth) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    const std::vector<std::uint8_t> both = slit(mesh, -0.3, 0.3);
    std::vector<std::uint8_t> one = both;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h)
            one[h] = 0;
    EXPECT_NE(one, both);
    EXPECT_EQ(make_chart_map(mesh, zeros(mesh), one, true).seam,
              make_chart_map(mesh, zeros(mesh), both, true).seam);
}

TEST(Charts, OneSurfaceIsTheSameAsAmongAll) {
    const Mesh mesh = checks::gated(shapes::sphere(2));
    std::vector<Index> labels;
    for (const Vec3& centre : mesh.face_centers)
        labels.push_back((centre.x() > 0.1 ? 1 : 0) + (centre.y() > -0.2 ? 2 : 0));
    const ChartMap charts = make_chart_map(mesh, labels, {}, false);
    for (const ChartSurface& expected : extract_charts(mesh, charts)) {
        const ChartSurface surface = extract_surface(mesh, expected.face, charts.seam);
        EXPECT_EQ(surface.faces, expected.faces);
        EXPECT_EQ(surface.vertex, expected.vertex);
        EXPECT_EQ(surface.twin, expected.twin);
        EXPECT_EQ(surface.loops, expected.loops);
        EXPECT_EQ(surface.edge_count, expected.edge_count);
    }
}

CornerUv uv_of(const Mesh& mesh) {
    CornerUv uv;
    for (const Triangle& t : mesh.faces)
        for (const Index v : t)
            uv.push_back(mesh.points[v].head<2>());
    return uv;
}

TEST(ChartsFromUv, CoordinatesThatAgreeAreNoSeams) {
    const Mesh mesh = checks::gated(shapes::grid(6, 6));
    CornerUv uv = uv_of(mesh);
    EXPECT_EQ(charts_from_uv(mesh, uv).count, 1);
    const double size = std::sqrt(2.0); // of the layout, which is [−½, ½]²
    uv[3 * 20].x() += 0.9e-6 * size;    // within the rounding of writers
    const auto seams = [&] {
        const ChartMap charts = charts_from_uv(mesh, uv);
        return std::count(charts.seam.begin(), charts.seam.end(), 1);
    };
    EXPECT_EQ(seams(), 0);
    uv[3 * 20].x() += 0.2e-6 * size;
    EXPECT_EQ(seams(), 4); // the two edges at that corner, from both sides
}

TEST(ChartsFromUv, IslandsAndSlitsAreFound) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    CornerUv uv = uv_of(mesh);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        if (mesh.face_centers[f].x() > 0.0)
            for (Index k = 0; k < 3; ++k)
                uv[3 * f + k] += Vec2(3.0, 0.0);
    EXPECT_EQ(charts_from_uv(mesh, uv).seam,
              make_chart_map(mesh, zeros(mesh), slit(mesh, -1.0, 1.0), true).seam);
    EXPECT_EQ(charts_from_uv(mesh, uv).count, 2);
    // A dart: the coordinates on its two sides differ, and meet at its tip.
    uv = uv_of(mesh);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        for (Index k = 0; k < 3; ++k) {
            Vec2& p = uv[3 * f + k];
            if (mesh.face_centers[f].x() > 0.0 && p.y() < 0.0)
                p.x() -= 0.3 * p.y();
        }
    const ChartMap dart = charts_from_uv(mesh, uv);
    EXPECT_EQ(dart.seam, make_chart_map(mesh, zeros(mesh), slit(mesh, -1.0, 0.0), true).seam);
    EXPECT_EQ(dart.count, 1);
    EXPECT_TRUE(extract_charts(mesh, dart).at(0).is_disk());
}

} // namespace
} // namespace devseg::atlas
