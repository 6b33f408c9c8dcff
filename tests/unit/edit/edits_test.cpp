// Joining, splitting, removing seams and cutting darts: valid charts, or refused with a reason.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/edit/chosen.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::edit {
namespace {

using checks::contains;
using checks::error_of;
using checks::run;
using checks::value;
using declare::HostMesh;
using declare::HostResult;
using declare::ParameterValues;

Vec3 middle_of(const HostMesh& host, std::size_t face) {
    const Triangle& t = host.geometry.faces[face];
    return (host.geometry.points[t[0]] + host.geometry.points[t[1]] + host.geometry.points[t[2]]) /
           3.0;
}

template <class On>
void select(HostMesh& host, On on) {
    host.face_selected.clear();
    for (std::size_t f = 0; f < host.geometry.faces.size(); ++f)
        host.face_selected.push_back(on(middle_of(host, f)) ? 1 : 0);
}

// Charts of `count` equal angles about the z axis.
HostMesh in_wedges(const mesh::RawMesh& raw, int count) {
    HostMesh host = checks::host_of(raw);
    for (std::size_t f = 0; f < raw.faces.size(); ++f) {
        const Vec3 p = middle_of(host, f);
        host.chart_id.push_back(std::floor((std::atan2(p.y(), p.x()) + pi) / (2.0 * pi) * count));
    }
    return host;
}

// Every chart is a disk, by a count that shares no code with the filters; seams agree.
void expect_disks(const HostMesh& host, const HostResult& r) {
    checks::expect_agreement(host.geometry, r);
    HostMesh laid = host;
    checks::take_charts(laid, r);
    const HostResult measured = run("Charts: Measure Segmentation", laid);
    EXPECT_EQ(value(measured, "disk_charts_number"), value(r, "charts_number"));
}

TEST(JoinSelected, PartsOfACylinderBecomeOneChart) {
    HostMesh host = in_wedges(shapes::cylinder_tube(24, 8), 4);
    select(host, [](const Vec3& p) { return p.x() > 0.0 && std::abs(p.y()) < 0.3; });
    const HostResult r = run("Charts: Join Selected", host);
    EXPECT_EQ(value(r, "charts_number"), 3);
    EXPECT_EQ(value(r, "changed_charts_number"), 1);
    EXPECT_NEAR(value(r, "l2_stretch"), 1.0, 1e-6);
    expect_disks(host, r);
    select(host, [](const Vec3&) { return true; });
    const HostResult all = run("Charts: Join Selected", host); // a ring, which is cut open
    EXPECT_EQ(value(all, "charts_number"), 1);
    EXPECT_GT(value(all, "cut_length"), 1.9);
    expect_disks(host, all);
}

TEST(JoinSelected, WhatStretchesTooMuchIsRefusedWithTheStretch) {
    HostMesh host = in_wedges(shapes::sphere(3), 8);
    select(host, [](const Vec3&) { return true; });
    const std::string text =
        error_of<InvalidParameter>([&] { run("Charts: Join Selected", host); });
    EXPECT_TRUE(contains(text, "L2 stretch of 1."));
    EXPECT_TRUE(contains(text, "above 1.02"));
    EXPECT_TRUE(contains(text, "force"));
    const HostResult forced = run("Charts: Join Selected", host, {{"force", true}});
    EXPECT_EQ(value(forced, "charts_number"), 1);
    expect_disks(host, forced);
    const HostResult bounded = run("Charts: Join Selected", host, {{"max_chart_l2_stretch", 50.0}});
    EXPECT_EQ(bounded.chart_id, forced.chart_id);
}

TEST(JoinSelected, WhatWouldLieOnItselfIsRefusedWithTheStretch) {
    HostMesh host = checks::host_of(shapes::helix_strip(40, 1.6, 0.6, 1.0, 0.5));
    const std::size_t count = host.geometry.faces.size();
    for (std::size_t f = 0; f < count; ++f)
        host.chart_id.push_back(2 * f < count ? 0.0 : 1.0);
    select(host, [](const Vec3&) { return true; });
    const std::string text =
        error_of<InvalidParameter>([&] { run("Charts: Join Selected", host); });
    EXPECT_TRUE(contains(text, "lie on each other, at an L2 stretch of 1")) << text;
    EXPECT_EQ(value(run("Charts: Join Selected", host, {{"force", true}}), "charts_number"), 1);
}

TEST(JoinSelected, OneChartOrChartsApartAreRefused) {
    HostMesh host = in_wedges(shapes::cylinder_tube(24, 8), 6);
    select(host, [](const Vec3& p) { return std::atan2(p.y(), p.x()) > 0.9 * pi; });
    EXPECT_TRUE(contains(error_of<InvalidParameter>([&] { run("Charts: Join Selected", host); }),
                         "found 1"));
    select(host, [](const Vec3& p) {
        const double turn = std::atan2(p.y(), p.x());
        return std::abs(turn - 0.5) < 0.2 || std::abs(turn + 2.5) < 0.2;
    });
    EXPECT_TRUE(contains(error_of<InvalidParameter>([&] { run("Charts: Join Selected", host); }),
                         "hang together"));
}

TEST(SplitSelected, AlongTheBorderOfTheSelectionOrTheBestWay) {
    HostMesh host = in_wedges(shapes::cylinder_tube(24, 8), 2);
    select(host, [&](const Vec3& p) {
        return p.y() > 0.0 && p.z() < host.geometry.points[0].z() + 1.0 &&
               p.z() > host.geometry.points[0].z() - 1.0;
    });
    const HostResult r = run("Charts: Split Selected", host);
    EXPECT_EQ(value(r, "charts_number"), 3);
    expect_disks(host, r);
    for (std::size_t f = 0; f < r.chart_id.size(); ++f)
        for (std::size_t g = 0; g < f; ++g)
            if (host.face_selected[f] != host.face_selected[g]) {
                ASSERT_NE(r.chart_id[f], r.chart_id[g]);
            }
    select(host, [](const Vec3& p) { return p.y() > 0.0; }); // a whole chart
    const HostResult best = run("Charts: Split Selected", host);
    EXPECT_EQ(value(best, "charts_number"), 3);
    EXPECT_EQ(value(best, "changed_charts_number"), 2);
    expect_disks(host, best);
}

TEST(SplitSelected, ALineThatEndsInsideIsLedOn) {
    HostMesh host = in_wedges(shapes::cylinder_tube(24, 8), 2);
    const double low = host.geometry.points[0].z();
    for (const Triangle& t : host.geometry.faces) {
        int bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p =
                0.5 * (host.geometry.points[t[k]] + host.geometry.points[t[(k + 1) % 3]]);
            if (std::abs(p.x()) < 1e-6 && p.y() > 0.0 && std::abs(p.z() - low) < 0.8)
                bits |= 1 << k;
        }
        host.edge_selected.push_back(static_cast<std::uint8_t>(bits));
    }
    select(host, [](const Vec3& p) { return p.y() > 0.0; });
    const HostResult r = run("Charts: Split Selected", host);
    EXPECT_EQ(value(r, "charts_number"), 3);
    for (std::size_t f = 0; f < r.chart_id.size(); ++f)
        for (std::size_t g = 0; g < f; ++g)
            if (middle_of(host, f).y() > 0.0 && middle_of(host, g).y() > 0.0) {
                ASSERT_EQ(r.chart_id[f] == r.chart_id[g],
                          (middle_of(host, f).x() > 0.0) == (middle_of(host, g).x() > 0.0));
            }
}

TEST(SplitSelected, SliversAreRefused) {
    HostMesh host = in_wedges(shapes::cylinder_tube(40, 20), 2);
    select(host, [](const Vec3&) { return false; });
    host.face_selected[100] = 1;
    EXPECT_TRUE(contains(error_of<InvalidParameter>([&] { run("Charts: Split Selected", host); }),
                         "sliver"));
    EXPECT_EQ(value(run("Charts: Split Selected", host, {{"force", true}}), "charts_number"), 3);
}

TEST(RemoveSeams, WholeSeamsOrJustWhatIsSelected) {
    HostMesh host = in_wedges(shapes::cylinder_tube(24, 8), 4);
    const double low = host.geometry.points[0].z();
    select(host, [&](const Vec3& p) {
        return p.x() > 0.0 && std::abs(p.y()) < 0.3 && std::abs(p.z() - low) < 0.5;
    });
    const HostResult whole = run("Charts: Remove Selected Seams", host);
    EXPECT_EQ(value(whole, "charts_number"), 3);
    EXPECT_NEAR(value(whole, "seam_length"), 6.0, 1e-9);
    expect_disks(host, whole);
    const HostResult part = run("Charts: Remove Selected Seams", host, {{"whole_seams", false}});
    EXPECT_EQ(value(part, "charts_number"), 3);
    EXPECT_GT(value(part, "seam_length"), 7.0);
    expect_disks(host, part);
    select(host, [&](const Vec3& p) { return p.x() > 0.6 && p.y() > 0.3; });
    EXPECT_TRUE(contains(error_of<InvalidMesh>([&] { run("Charts: Remove Selected Seams", host); }),
                         "no chosen"));
}

// The middle of a chart.
std::size_t vertex_near(const HostMesh& host, const Vec3& place) {
    std::size_t best = 0;
    for (std::size_t v = 0; v < host.geometry.points.size(); ++v)
        if ((host.geometry.points[v] - place).norm() < (host.geometry.points[best] - place).norm())
            best = v;
    return best;
}

TEST(AddDart, LowersTheStretchOrIsRefused) {
    std::vector<Vec2> profile;
    for (int i = 0; i <= 12; ++i)
        profile.emplace_back(i % 12 == 0 ? 0.0 : std::sin(pi * i / 12.0), -std::cos(pi * i / 12.0));
    HostMesh ball = in_wedges(shapes::revolve(profile, 24), 2);
    ball.vertex_selected.assign(ball.geometry.points.size(), 0);
    ball.vertex_selected[vertex_near(ball, {0.0, 1.0, 0.0})] = 1;
    const HostResult r = run("Charts: Add Dart", ball);
    EXPECT_EQ(value(r, "charts_number"), 2);
    EXPECT_LT(value(r, "l2_stretch"), value(r, "l2_stretch_before") - 1e-3);
    EXPECT_GT(value(r, "cut_length"), 1.0);
    expect_disks(ball, r);

    HostMesh tube = in_wedges(shapes::cylinder_tube(24, 8), 2);
    const std::size_t inside = vertex_near(
        tube, {0.0, 1.0, 0.5 * (tube.geometry.points.front() + tube.geometry.points.back()).z()});
    const ParameterValues there{{"vertices", std::to_string(inside)}};
    EXPECT_TRUE(contains(error_of<InvalidParameter>([&] { run("Charts: Add Dart", tube, there); }),
                         "gains nothing"));
    ParameterValues forced = there;
    forced["force"] = true;
    EXPECT_GT(value(run("Charts: Add Dart", tube, forced), "cut_length"), 0.2);
}

TEST(Edits, ValidOrRefusedAndUnchangedOnRandomPairs) {
    mesh::RawMesh raw = shapes::sphere(3);
    for (Vec3& p : raw.points)
        p *= 1.0 + 0.15 * std::sin(3.0 * p.x() + 1.0) * std::cos(4.0 * p.z());
    HostMesh host = checks::host_of(raw);
    checks::take_charts(
        host, run("Segmentation: Variational Shape Approximation", host, {{"charts_number", 16}}));
    std::mt19937 random(7);
    int joined = 0;
    for (int i = 0; i < 50; ++i) {
        HostMesh own = host;
        const auto face = random() % raw.faces.size();
        select(own, [&](const Vec3& p) { return (p - middle_of(host, face)).norm() < 0.35; });
        const bool joins = i % 2 == 0;
        try {
            const HostResult r =
                run(joins ? "Charts: Join Selected" : "Charts: Split Selected", own);
            joined += joins ? 1 : 0;
            expect_disks(own, r);
            checks::take_charts(own, r);
            const HostResult flat = run("Charts: Flatten", own, {{"pack", false}});
            own.wedge_uv = flat.wedge_uv;
            const HostResult measured = run("Charts: Measure Flattening", own);
            EXPECT_EQ(value(measured, "flipped_faces_number"), 0);
            EXPECT_EQ(value(measured, "overlapping_faces_number"), 0);
            if (joins) { // judged by the map that flattening then makes
                EXPECT_EQ(value(flat, "charts_number"), value(r, "charts_number"));
                EXPECT_LE(value(r, "l2_stretch"), 1.02);
            }
        } catch (const InvalidParameter&) {
        }
    }
    EXPECT_GT(joined, 3);
}

TEST(Numbers, OfPiecesAndSeamsAreThoseOfThePattern) {
    HostMesh host = in_wedges(shapes::cylinder_tube(24, 8), 4);
    host.wedge_uv = run("Charts: Flatten", host, {{"pack", false}}).wedge_uv;
    const HostResult joined = run("Charts: Join Selected", host, {{"pieces", "P01, 2"}});
    EXPECT_EQ(value(joined, "charts_number"), 3);
    std::map<double, int> now; // each old chart lies in one of now; the first two in the same
    for (std::size_t f = 0; f < host.chart_id.size(); ++f)
        now[host.chart_id[f]] = joined.chart_id[f];
    EXPECT_EQ(value(run("Charts: Split Selected", host, {{"pieces", "4"}}), "charts_number"), 5);
    for (int seam = 1; seam <= 4; ++seam) {
        const HostResult r =
            run("Charts: Remove Selected Seams", host, {{"seams", std::to_string(seam)}});
        EXPECT_EQ(value(r, "charts_number"), 3);
        EXPECT_NEAR(value(r, "seam_length"), 6.0, 1e-9);
    }
    for (const char* text : {"0", "5", "1,99"})
        EXPECT_TRUE(contains(error_of<InvalidParameter>([&] {
                                 run("Charts: Join Selected", host, {{"pieces", text}});
                             }),
                             "from 1 to 4"));
    EXPECT_TRUE(
        contains(error_of<InvalidParameter>([&] { read_numbers("seams", "3,x4"); }), "found 'x4'"));
    EXPECT_EQ(read_numbers("seams", " 3,,P04 "), (std::vector<int>{3, 4}));
    HostMesh whole = host; // numbers stay those of the pattern when seams go
    checks::take_charts(whole, run("Charts: Remove Selected Seams", host, {{"seams", "1"}}));
    EXPECT_TRUE(contains(error_of<InvalidMesh>([&] {
                             run("Charts: Remove Selected Seams", whole, {{"seams", "1"}});
                         }),
                         "seams: expected seams of the charts"));
}

} // namespace
} // namespace devseg::edit
