// Charts from what the user has: selected edges and faces, texture coordinates, colours.
#include "devseg/edit/given_charts.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "devseg/atlas/slit_closing.h"
#include "devseg/base/errors.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::edit {
namespace {

using checks::run;
using checks::value;
using declare::HostMesh;
using declare::HostResult;

// Marks the edges both of whose ends fulfil `on`.
template <class On>
std::vector<std::uint8_t> edges_where(const Mesh& mesh, On on) {
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0)
            seam[h] = on(mesh.points[mesh.origin(h)]) && on(mesh.points[mesh.target(h)]) ? 1 : 0;
    return seam;
}

Index charts_of(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    return atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, true).count;
}

double length_of(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    double length = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        length += seam[h] != 0 ? 0.5 * mesh.edge_length(h) : 0.0;
    return length;
}

TEST(CompleteCuts, ACutFromTheRimGoesOnToTheOtherRim) {
    const Mesh mesh = checks::gated(shapes::cylinder_tube(24, 12));
    const double top = mesh.points[0].z() > 0.0 ? 1.0 : -1.0;
    const auto is_meridian = [&](const Vec3& p) {
        return p.x() > 0.0 && std::abs(p.y()) < 1e-9 && top * p.z() > -1e-9;
    };
    const std::vector<std::uint8_t> half = edges_where(mesh, is_meridian);
    const double drawn = length_of(mesh, half);
    ASSERT_GT(drawn, 0.0);
    const CompletedCuts cuts = complete_cuts(mesh, half, Progress());
    EXPECT_EQ(cuts.completed, 1);
    EXPECT_EQ(cuts.loose, 0);
    // Straight on, and not back beside itself.
    EXPECT_NEAR(length_of(mesh, cuts.seam), 2.0 * drawn, 1e-9);
    EXPECT_EQ(charts_of(mesh, cuts.seam), 1);
}

TEST(CompleteCuts, AnArcOnASphereBecomesALoop) {
    const Mesh mesh =
        checks::gated(shapes::revolve({{0, -1}, {0.7, -0.7}, {1, 0}, {0.7, 0.7}, {0, 1}}, 32));
    const auto on_equator = [&](const Vec3& p) { return std::abs(p.z()) < 1e-9 && p.x() > 0.0; };
    const std::vector<std::uint8_t> arc = edges_where(mesh, on_equator);
    EXPECT_EQ(charts_of(mesh, arc), 1);
    const CompletedCuts cuts = complete_cuts(mesh, arc, Progress());
    EXPECT_EQ(cuts.completed, 1); // one path joins both ends
    EXPECT_EQ(cuts.loose, 0);
    EXPECT_EQ(charts_of(mesh, cuts.seam), 2);
    for (const Index degree : atlas::cut_edges_at_vertices(mesh, cuts.seam))
        EXPECT_TRUE(degree == 0 || degree == 2);
}

TEST(CompleteCuts, WholeCutsStay) {
    const Mesh mesh = checks::gated(shapes::sphere(3));
    std::vector<std::uint8_t> half(mesh.faces.size(), 0);
    for (const Face f : mesh.all_faces())
        half[f] = mesh.face_centers[f].x() > 0.0 ? 1 : 0;
    const std::vector<std::uint8_t> border = borders_of(mesh, half);
    const CompletedCuts cuts = complete_cuts(mesh, border, Progress());
    EXPECT_EQ(cuts.seam, border);
    EXPECT_EQ(cuts.completed, 0);
}

Vec3 middle_of(const HostMesh& host, const Triangle& t) {
    return (host.geometry.points[t[0]] + host.geometry.points[t[1]] + host.geometry.points[t[2]]) /
           3.0;
}

HostMesh sphere_with_cap() {
    HostMesh host = checks::host_of(shapes::sphere(3));
    for (const Triangle& t : host.geometry.faces)
        host.face_selected.push_back(middle_of(host, t).z() > 0.5 ? 1 : 0);
    return host;
}

TEST(GivenCharts, BordersOfSelectedFacesBecomeSeams) {
    const HostMesh host = sphere_with_cap();
    const HostResult r = run("Charts: From Selected Edges", host);
    EXPECT_EQ(value(r, "charts_number"), 2);
    checks::expect_agreement(host.geometry, r);
    for (std::size_t f = 0; f < r.chart_id.size(); ++f)
        EXPECT_EQ(r.chart_id[f] == r.chart_id[0], host.face_selected[f] == host.face_selected[0]);
}

TEST(GivenCharts, ASecondSelectionAddsToTheSeamsThatThereAre) {
    HostMesh host = sphere_with_cap();
    checks::take_charts(host, run("Charts: From Selected Edges", host));
    for (std::size_t f = 0; f < host.face_selected.size(); ++f)
        host.face_selected[f] = middle_of(host, host.geometry.faces[f]).x() > 0.0 ? 1 : 0;
    EXPECT_EQ(value(run("Charts: From Selected Edges", host), "charts_number"), 2);
    const HostResult both = run("Charts: From Selected Edges", host, {{"keep", 1}});
    EXPECT_EQ(value(both, "charts_number"), 4);
    checks::expect_agreement(host.geometry, both);
    host.edge_selected.assign(host.seam_edges.begin(), host.seam_edges.end()); // as hosts mirror it
    EXPECT_EQ(value(run("Charts: From Selected Edges", host), "charts_number"), 4);
}

TEST(GivenCharts, RegionsOfColoursAndMaterialsAreCharts) {
    HostMesh host = checks::host_of(shapes::cube(4));
    for (const Triangle& t : host.geometry.faces) {
        const Vec3 middle = middle_of(host, t);
        const bool left = middle.x() < 0.5 * (host.geometry.points[0].x() * 2.0 + 1.0);
        host.face_color.push_back(left ? declare::Color{255, 0, 0} : declare::Color{0, 0, 255});
        host.face_material.push_back(middle.z() < middle.x() ? 7 : 3);
    }
    const auto charts = [&](int source) {
        const HostResult r = run("Charts: From Colors or Materials", host, {{"source", source}});
        checks::expect_agreement(host.geometry, r);
        return value(r, "charts_number");
    };
    EXPECT_EQ(charts(0), 2);
    EXPECT_EQ(charts(1), 2);
    EXPECT_EQ(charts(2), 1);
}

// Charts are as they were, their seams shorter, and the surface the same.
void expect_smooth(const HostMesh& host, const char* filter, declare::ParameterValues values) {
    SCOPED_TRACE(filter);
    const HostResult plain = run(filter, host, values);
    EXPECT_FALSE(plain.refinement.has_value());
    values["smooth"] = true;
    const HostResult smooth = run(filter, host, values);
    ASSERT_TRUE(smooth.refinement.has_value());
    const mesh::RawMesh fine = checks::refined(host.geometry, smooth);
    EXPECT_GT(fine.faces.size(), host.geometry.faces.size());
    EXPECT_TRUE(checks::is_valid(checks::gated(fine)));
    checks::expect_agreement(fine, smooth);
    EXPECT_EQ(smooth.face_color.size(), fine.faces.size());
    EXPECT_EQ(value(smooth, "charts_number"), value(plain, "charts_number"));
    EXPECT_LT(value(smooth, "seam_length"), 0.97 * value(plain, "seam_length"));
}

TEST(GivenCharts, SeamsBecomeSmoothWhereThatIsWanted) {
    HostMesh host = sphere_with_cap();
    for (const std::uint8_t selected : host.face_selected) {
        host.face_material.push_back(selected);
        host.face_color.push_back({selected, 0, 0});
    }
    for (std::size_t f = 0; f < host.face_selected.size(); ++f) { // two islands
        const double left = host.face_selected[f] != 0 ? 5.0 : 0.0;
        std::array<Vec2, 3>& corners = host.wedge_uv.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] =
                host.geometry.points[host.geometry.faces[f][k]].head<2>() + Vec2(left, 0.0);
    }
    expect_smooth(host, "Charts: From Selected Edges", {});
    expect_smooth(host, "Charts: From Texture Coordinates", {});
    expect_smooth(host, "Charts: From Colors or Materials", {{"source", 0}});
    expect_smooth(host, "Charts: From Colors or Materials", {{"source", 1}});
}

TEST(GivenCharts, OnlyNewSeamsBecomeSmooth) {
    HostMesh host = sphere_with_cap();
    checks::take_charts(host, run("Charts: From Selected Edges", host));
    for (std::size_t f = 0; f < host.face_selected.size(); ++f)
        host.face_selected[f] = middle_of(host, host.geometry.faces[f]).x() > 0.3 ? 1 : 0;
    const HostResult kept =
        run("Charts: From Selected Edges", host, {{"keep", 1}, {"smooth", true}});
    EXPECT_EQ(value(kept, "charts_number"), 4);
    checks::expect_agreement(checks::refined(host.geometry, kept), kept);
    checks::expect_kept_seams(host, kept);
    // The cap stays as it is, and the rest of the ball is divided.
    for (std::size_t f = 0; f < host.chart_id.size(); ++f)
        host.chart_id[f] = middle_of(host, host.geometry.faces[f]).z() > 0.5 ? 3.0 : -1.0;
    const HostResult rest =
        run("Charts: From Selected Edges", host, {{"keep", 2}, {"smooth", true}});
    const mesh::RawMesh fine = checks::refined(host.geometry, rest);
    checks::expect_agreement(fine, rest);
    for (std::size_t f = 0; f < host.chart_id.size(); ++f)
        EXPECT_EQ(rest.chart_id[f] == 3, host.chart_id[f] > 0.0) << f;
    EXPECT_EQ(std::set<int>(rest.chart_id.begin(), rest.chart_id.end()).size(), 3U);
}

// A ball of six gores, each gore an island at a scale of its own.
HostMesh gored_ball(double mirror) {
    HostMesh host = checks::host_of(shapes::revolve(
        {{0, -1}, {0.5, -0.87}, {0.87, -0.5}, {1, 0}, {0.87, 0.5}, {0.5, 0.87}, {0, 1}}, 36));
    for (const Triangle& t : host.geometry.faces) {
        const Vec3 middle = middle_of(host, t);
        const int gore =
            static_cast<int>(std::floor((std::atan2(middle.y(), middle.x()) + pi) / (pi / 3.0)));
        const double axis = -pi + (gore + 0.5) * pi / 3.0;
        std::array<Vec2, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& p = host.geometry.points[t[k]];
            const double radius = p.head<2>().norm();
            const double angle =
                radius > 1e-9 ? std::remainder(std::atan2(p.y(), p.x()) - axis, 2.0 * pi) : 0.0;
            const double scale = 1.0 + 0.4 * gore;
            corners[k] = {scale * radius * angle * (gore % 2 == 1 ? mirror : 1.0) + 10.0 * gore,
                          scale * p.z()};
        }
        host.wedge_uv.push_back(corners);
    }
    return host;
}

TEST(GivenCharts, IslandsOfTextureCoordinatesAreChartsWithTheirTrueSize) {
    for (const double mirror : {1.0, -1.0}) {
        HostMesh host = gored_ball(mirror);
        const HostResult r = run("Charts: From Texture Coordinates", host);
        EXPECT_EQ(value(r, "charts_number"), 6);
        checks::expect_agreement(host.geometry, r);
        checks::take_charts(host, r);
        const HostResult flat = run("Charts: Flatten", host, {{"pack", false}});
        EXPECT_EQ(value(flat, "charts_number"), 6);
        std::vector<double> plane(6, 0.0);
        std::vector<double> surface(6, 0.0);
        for (std::size_t f = 0; f < flat.chart_id.size(); ++f) {
            plane[at(flat.chart_id[f])] += checks::signed_area(flat.wedge_uv[f]);
            surface[at(flat.chart_id[f])] += checks::area_on_surface(host.geometry, f);
        }
        for (std::size_t c = 0; c < 6; ++c)
            EXPECT_NEAR(plane[c] / surface[c], 1.0, 1e-4);
    }
}

TEST(GivenCharts, CoarseToleranceJoinsIslands) {
    HostMesh host = gored_ball(1.0);
    for (std::array<Vec2, 3>& corners : host.wedge_uv)
        for (Vec2& p : corners)
            p.x() = 100.0 + 1e-3 * p.x(); // apart by a hundredth of the height
    EXPECT_EQ(value(run("Charts: From Texture Coordinates", host), "charts_number"), 6);
    EXPECT_EQ(value(run("Charts: From Texture Coordinates", host, {{"weld_tolerance", 0.1}}),
                    "charts_number"),
              1);
}

TEST(GivenCharts, ACutMeshIsOpenAndStillTheSameCharts) {
    HostMesh host = sphere_with_cap();
    const HostResult charts = run("Charts: From Selected Edges", host);
    checks::take_charts(host, charts);
    const HostResult cut = run("Charts: Cut Mesh Along Seams", host);
    const mesh::RawMesh open = checks::refined(host.geometry, cut);
    EXPECT_EQ(open.faces.size(), host.geometry.faces.size());
    for (const auto& [ends, faces] : checks::edges_of(open)) {
        if (faces.size() == 2) {
            EXPECT_EQ(cut.chart_id[faces[0].first], cut.chart_id[faces[1].first]);
        } else {
            EXPECT_EQ(cut.seam_edges[faces[0].first] >> faces[0].second & 1, 1);
        }
    }
    HostMesh again = checks::host_of(open);
    checks::take_charts(again, cut);
    EXPECT_EQ(value(run("Charts: Colorize", again), "charts_number"), 2);
}

TEST(CutMesh, EachSideOfASeamGetsItsVertices) {
    HostMesh host = checks::host_of(shapes::cylinder_tube(12, 4));
    for (const Triangle& t : host.geometry.faces) { // along a meridian
        int bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& p = host.geometry.points[t[k]];
            const Vec3& q = host.geometry.points[t[(k + 1) % 3]];
            if (std::abs(p.y()) < 1e-9 && std::abs(q.y()) < 1e-9 && p.x() > 0.0 && q.x() > 0.0)
                bits |= 1 << k;
        }
        host.seam_edges.push_back(bits);
    }
    const HostResult cut = run("Charts: Cut Mesh Along Seams", host);
    const mesh::RawMesh open = checks::refined(host.geometry, cut);
    EXPECT_EQ(open.points.size(), host.geometry.points.size() + 5); // one for each on the cut
    EXPECT_EQ(value(cut, "new_vertices_number"), 5);
    EXPECT_TRUE(checks::is_valid(checks::gated(open)));
}

TEST(CutMesh, DoubledFacesStayOnTheirTwins) {
    HostMesh host = sphere_with_cap();
    checks::take_charts(host, run("Charts: From Selected Edges", host));
    const std::size_t count = host.geometry.faces.size();
    for (std::size_t f = 0; f < count; ++f) { // every face twice, some of them turned over
        Triangle twin = host.geometry.faces[f];
        if (f % 2 == 0)
            std::swap(twin[0], twin[1]);
        host.geometry.faces.push_back(twin);
    }
    host.face_selected.clear();
    for (auto* values : {&host.chart_id, &host.seam_edges})
        values->resize(2 * count, 0.0);
    const HostResult cut = run("Charts: Cut Mesh Along Seams", host);
    EXPECT_GT(value(cut, "new_vertices_number"), 0);
    const mesh::RawMesh open = checks::refined(host.geometry, cut);
    for (std::size_t f = 0; f < count; ++f) {
        Triangle twin = open.faces[count + f];
        if (f % 2 == 0)
            std::swap(twin[0], twin[1]);
        EXPECT_EQ(twin, open.faces[f]) << f;
    }
}

TEST(CutMesh, SheetsThatMeetAtOneEdgeComeApart) {
    HostMesh host;
    host.geometry.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    host.geometry.faces = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    const HostResult cut = run("Charts: Cut Mesh Along Seams", host);
    EXPECT_EQ(value(cut, "charts_number"), 3);
    EXPECT_EQ(value(cut, "new_vertices_number"), 4); // both ends of the edge, three times each
    const mesh::RawMesh open = checks::refined(host.geometry, cut);
    for (const auto& [ends, faces] : checks::edges_of(open))
        EXPECT_EQ(faces.size(), 1U);
}

// Files have two vertices where texture coordinates differ: they are read as one, and still what
// hangs together at either of them goes on to do so.
TEST(CutMesh, VerticesAtTheSamePlaceAreNoReasonToTearFacesApart) {
    HostMesh host = sphere_with_cap();
    checks::take_charts(host, run("Charts: From Selected Edges", host));
    const auto count = static_cast<Index>(host.geometry.points.size());
    const std::vector<Vec3> points = host.geometry.points;
    host.geometry.points.insert(host.geometry.points.end(), points.begin(), points.end());
    for (Triangle& t : host.geometry.faces)
        if (middle_of(host, t).x() > 0.0)
            for (Index& v : t)
                v += count;
    const HostResult cut = run("Charts: Cut Mesh Along Seams", host);
    const mesh::RawMesh open = checks::refined(host.geometry, cut);
    const checks::Edges edges = checks::edges_of(open);
    int torn = 0;
    for (const auto& [ends, faces] : checks::edges_of(host.geometry)) {
        if (faces.size() != 2)
            continue;
        const Triangle& t = open.faces[faces[0].first];
        const int k = faces[0].second;
        const std::size_t sides = edges.at({t[at(k)], t[at((k + 1) % 3)]}).size();
        const bool is_seam = (cut.seam_edges[faces[0].first] >> k & 1) != 0;
        EXPECT_EQ(sides, is_seam ? 1U : 2U);
        torn += is_seam ? 1 : 0;
    }
    EXPECT_GT(torn, 10);
}

} // namespace
} // namespace devseg::edit
