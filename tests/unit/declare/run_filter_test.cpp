#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/declare/filter.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::declare {
namespace {

using checks::contains;
using checks::edges_of;
using checks::expect_agreement;
using checks::host_of;
using checks::run;
using checks::signed_area;
using checks::take_charts;
using checks::value;

mesh::RawMesh noisy_torus() {
    return shapes::with_noise(shapes::torus(24, 14, 2.0, 0.9), 0.03, 4);
}

TEST(RunFilter, BothFacesOfAnEdgeAgreeWhateverTheirOrientation) {
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
        const mesh::RawMesh raw =
            seed == 0 ? noisy_torus() : shapes::with_random_orientations(noisy_torus(), seed);
        HostMesh host = host_of(raw);
        const HostResult segmented = run("Segmentation: D-Charts", host);
        expect_agreement(raw, segmented);
        // The way in again: nothing is left to cut, and nothing changes.
        take_charts(host, segmented);
        const HostResult again = run("Charts: Cut to Disks", host);
        EXPECT_EQ(again.chart_id, segmented.chart_id);
        EXPECT_EQ(again.seam_edges, segmented.seam_edges);
        EXPECT_EQ(value(again, "cut_charts_number"), 0);
        EXPECT_NEAR(value(run("Charts: Measure Segmentation", host), "seam_length"),
                    value(segmented, "seam_length"), 1e-9);
    }
}

TEST(RunFilter, TheOrientationOfFacesDoesNotChangeTheCharts) {
    const mesh::RawMesh raw = noisy_torus();
    mesh::RawMesh mixed = raw;
    for (std::size_t f = 0; f < mixed.faces.size(); f += 3) // a minority
        std::swap(mixed.faces[f][1], mixed.faces[f][2]);
    const HostResult a = run("Segmentation: D-Charts", host_of(raw));
    const HostResult b = run("Segmentation: D-Charts", host_of(mixed));
    EXPECT_EQ(a.chart_id, b.chart_id);
    EXPECT_EQ(a.face_quality, b.face_quality);
    for (std::size_t f = 0; f < raw.faces.size(); ++f) {
        const int bits = b.seam_edges[f]; // turned over, edges 0 and 2 change places
        const int mapped = f % 3 == 0 ? (bits & 2) | (bits & 1) << 2 | bits >> 2 : bits;
        EXPECT_EQ(mapped, a.seam_edges[f]);
    }
}

TEST(RunFilter, ChartsComeFromAttributesThenCoordinatesThenComponents) {
    mesh::RawMesh raw = shapes::grid(4, 1); // 8 faces
    HostMesh host = host_of(raw);
    const auto charts = [&] { return value(run("Charts: Colorize", host), "charts_number"); };
    EXPECT_EQ(charts(), 1);
    for (std::size_t f = 0; f < 8; ++f) {
        std::array<Vec2, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = raw.points[raw.faces[f][k]].head<2>() + Vec2(f < 4 ? 0.0 : 9.0, 0.0);
        host.wedge_uv.push_back(corners);
    }
    EXPECT_EQ(charts(), 2);
    host.chart_id = {5, 5, 0, 0, 0, 0, 5, 5};
    EXPECT_EQ(charts(), 3); // label 5 is in two places
    host.chart_id.clear();
    host.seam_edges.assign(8, 0.0);
    EXPECT_EQ(charts(), 1);
    host.seam_edges = {0, 0, 0, 0, 0, 0, 4, 0}; // one face says so: faces 6 and 7 share edge 2 of 6
    EXPECT_EQ(charts(), 2);
}

TEST(RunFilter, AttributesThatMakeNoSenseAreRefused) {
    HostMesh host = host_of(shapes::grid(2, 1));
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e12,
                             std::numeric_limits<double>::infinity()}) {
        host.chart_id = {0, 0, bad, 0};
        try {
            run("Charts: Cut to Disks", host);
            ADD_FAILURE() << "accepted " << bad;
        } catch (const InvalidMesh& error) {
            EXPECT_TRUE(contains(error.what(), "chart_id"));
            EXPECT_TRUE(contains(error.what(), "face 2"));
            EXPECT_EQ(error.faces, std::vector<Index>{2});
        }
    }
    host.chart_id.clear();
    host.seam_edges = {-1.0, 8.0, std::numeric_limits<double>::quiet_NaN(), 1e300}; // no bit masks
    EXPECT_EQ(value(run("Charts: Colorize", host), "charts_number"), 1);
}

TEST(RunFilter, BrokenCoordinatesOnlyMatterWhereTheyAreNeeded) {
    HostMesh host = host_of(shapes::grid(2, 1));
    host.wedge_uv.assign(4, {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)});
    host.wedge_uv[3][1].x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NO_THROW(run("Segmentation: D-Charts", host, {{"charts_number", 1}}));
    try {
        run("Charts: Pack", host);
        ADD_FAILURE() << "accepted";
    } catch (const InvalidMesh& error) {
        EXPECT_TRUE(contains(error.what(), "face 3"));
        EXPECT_EQ(error.faces, std::vector<Index>{3});
    }
}

TEST(RunFilter, FacesThatWereLeftOutTakeResultsOfOthers) {
    mesh::RawMesh raw = shapes::sphere(1);
    raw.faces.insert(raw.faces.begin(), Triangle{3, 3, 7}); // names a vertex twice
    raw.faces.push_back({raw.faces[9][1], raw.faces[9][0], raw.faces[9][2]}); // face 9, turned over
    HostMesh host = host_of(raw);
    const HostResult r = run("Segmentation: D-Charts", host, {{"charts_number", 4}});
    EXPECT_EQ(r.notes.size(), 2U);
    ASSERT_EQ(r.chart_id.size(), raw.faces.size());
    EXPECT_EQ(r.chart_id.back(), r.chart_id[9]);
    EXPECT_EQ(r.face_color.back(), r.face_color[9]);
    EXPECT_EQ(r.face_quality.back(), r.face_quality[9]);
    EXPECT_EQ(r.seam_edges.front(), 0);
    const std::set<int> labels(r.chart_id.begin(), r.chart_id.end());
    EXPECT_EQ(*labels.begin(), 0);
    EXPECT_EQ(*labels.rbegin() + 1, static_cast<int>(labels.size()));
    const HostResult flat = run("Charts: Flatten", host); // one chart: packed at once
    for (const std::size_t f : {std::size_t{0}, raw.faces.size() - 1})
        EXPECT_EQ(signed_area(flat.wedge_uv[f]), 0.0); // covers nothing
    take_charts(host, r);
    EXPECT_EQ(value(run("Charts: Measure Segmentation", host), "charts_number"), labels.size());
}

TEST(RunFilter, ErrorsNameTheHostsFaces) {
    mesh::RawMesh raw = shapes::grid(2, 1);
    raw.faces.insert(raw.faces.begin(), Triangle{1, 1, 2}); // the gate drops it
    HostMesh host = host_of(raw);
    host.wedge_uv.assign(5, {Vec2(0.5, 0.5), Vec2(0.5, 0.5), Vec2(0.5, 0.5)});
    try {
        run("Charts: Pack", host);
        ADD_FAILURE() << "accepted charts without area";
    } catch (const InvalidMesh& error) {
        EXPECT_EQ(error.faces, (std::vector<Index>{1, 2, 3, 4}));
    }
}

TEST(RunFilter, EdgesThatTheGateCutAreSeams) {
    const mesh::RawMesh fins = {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                                {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
    const HostResult r = run("Charts: Cut to Disks", host_of(fins));
    EXPECT_EQ(r.seam_edges, (std::vector<int>{1, 1, 1}));
    EXPECT_EQ(r.chart_id, (std::vector<int>{0, 1, 2}));
}

TEST(RunFilter, NeighbouringChartsHaveDifferentColours) {
    const mesh::RawMesh raw = shapes::sphere(3);
    const HostResult r =
        run("Segmentation: D-Charts", host_of(raw),
            {{"charts_number", 60}, {"merge_charts", false}, {"straighten_boundaries", false}});
    EXPECT_GE(value(r, "charts_number"), 60); // more than there are colours
    std::map<int, Color> color;
    for (std::size_t f = 0; f < raw.faces.size(); ++f)
        ASSERT_EQ(color.try_emplace(r.chart_id[f], r.face_color[f]).first->second, r.face_color[f]);
    for (const auto& [ends, faces] : edges_of(raw)) {
        const int a = r.chart_id[faces[0].first];
        const int b = r.chart_id[faces[1].first];
        ASSERT_TRUE(a == b || color[a] != color[b]);
    }
}

TEST(RunFilter, LengthsAreInModelUnits) {
    const mesh::RawMesh raw =
        shapes::moved(shapes::cylinder_tube(12, 4, 1.0, 3.0), 37.0, Vec3(5, 5, 5));
    HostMesh host = host_of(raw);
    const HostResult r = run("Charts: Cut to Disks", host);
    EXPECT_NEAR(value(r, "cut_length"), 3.0 * 37.0, 1e-9);
    take_charts(host, r);
    EXPECT_NEAR(value(run("Charts: Measure Segmentation", host), "seam_length"), 3.0 * 37.0, 1e-9);
}

TEST(RunFilter, MoreChartsThanFacesAreAsManyAsFaces) {
    mesh::RawMesh raw = shapes::tetrahedron();
    raw.faces.push_back(raw.faces.front()); // left out by the gate
    const HostMesh host = host_of(raw);
    for (const char* method : {"Segmentation: D-Charts", "Segmentation: t-flooding",
                               "Segmentation: Variational Shape Approximation",
                               "Segmentation: Multi-Chart Geometry Images",
                               "Segmentation: Papercraft with Creases and Slits"}) {
        SCOPED_TRACE(method);
        const HostResult own = run(method, host);
        EXPECT_EQ(own.notes.size(), 1U); // of the double face
        const HostResult asked = run(method, host, {{"charts_number", 8}});
        EXPECT_EQ(asked.chart_id, own.chart_id);
        ASSERT_EQ(asked.notes.size(), 2U);
        EXPECT_TRUE(contains(asked.notes[1], "8 charts were asked for, and the mesh has 4 faces"));
        EXPECT_THROW(run(method, host, {{"charts_number", -1}}), InvalidParameter);
    }
}

TEST(RunFilter, VerticesThatWereJoinedMoveTogether) {
    // A dome of flat-shaded triangles: all copies of a vertex stay at one place.
    const mesh::RawMesh dome = shapes::hemisphere(10, 4);
    HostMesh host;
    for (const Triangle& t : dome.faces) {
        const Index first = static_cast<Index>(host.geometry.points.size());
        for (const Index v : t)
            host.geometry.points.push_back(dome.points[v]);
        host.geometry.faces.push_back({first, first + 1, first + 2});
    }
    const HostResult r =
        run("Charts: Deform to Exact Developability", host,
            {{"keep_unfinished", true}, {"adjust_slits", false}, {"max_iterations", 3}});
    ASSERT_EQ(r.points.size(), host.geometry.points.size());
    std::vector<Vec3> place(dome.points.size(), Vec3::Constant(infinite));
    double moved = 0.0;
    for (std::size_t f = 0; f < dome.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3& one = place[at(dome.faces[f][k])];
            const Vec3& p = r.points[3 * f + k];
            one = std::isinf(one.x()) ? p : one;
            EXPECT_LT((one - p).norm(), 1e-12);
            moved = std::max(moved, (p - host.geometry.points[3 * f + k]).norm());
        }
    EXPECT_GT(moved, 1e-3);
}

TEST(RunFilter, FacesThatCoordinatesCannotExpressGetRoom) {
    // The middle rows become slivers, far too thin for 32 bits.
    HostMesh host = host_of(shapes::grid(12, 12));
    for (Vec3& p : host.geometry.points)
        if (std::abs(p.y() - 0.5) < 0.2)
            p.y() = 0.5 + 1e-12 * (p.y() - 0.5);
    const HostResult flat = run("Charts: Flatten", host);
    host.wedge_uv = flat.wedge_uv;
    const HostResult measured = run("Charts: Measure Flattening", host);
    EXPECT_EQ(value(measured, "flipped_faces_number"), 0.0);
    EXPECT_EQ(value(measured, "overlapping_faces_number"), 0.0);
}

} // namespace
} // namespace devseg::declare
