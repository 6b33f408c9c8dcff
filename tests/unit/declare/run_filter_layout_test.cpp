// The texture coordinates that hosts get from the filters.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "devseg/declare/filter.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::declare {
namespace {

using checks::area_on_surface;
using checks::edges_of;
using checks::expect_agreement;
using checks::host_of;
using checks::run;
using checks::signed_area;
using checks::sound_charts;
using checks::take_charts;
using checks::value;

mesh::RawMesh noisy_torus() {
    return shapes::with_noise(shapes::torus(24, 14, 2.0, 0.9), 0.03, 4);
}

TEST(Layout, TextureCoordinatesMeetExceptAtSeams) {
    for (const bool mixed : {false, true}) {
        mesh::RawMesh raw = noisy_torus();
        std::vector<bool> turned(raw.faces.size(), false);
        for (std::size_t f = 0; f < raw.faces.size() && mixed; f += 3) {
            std::swap(raw.faces[f][1], raw.faces[f][2]);
            turned[f] = true;
        }
        HostMesh host = host_of(raw);
        take_charts(host, run("Segmentation: D-Charts", host));
        const HostResult flat = run("Charts: Flatten", host);
        expect_agreement(raw, flat);
        for (const auto& [ends, faces] : edges_of(raw)) {
            const auto [f, e] = faces.at(0);
            const auto [g, d] = faces.at(1);
            for (const Index v : ends) {
                const auto corner = [&](std::size_t face) {
                    const Triangle& t = raw.faces[face];
                    return at(static_cast<Index>(std::find(t.begin(), t.end(), v) - t.begin()));
                };
                if ((flat.seam_edges[f] >> e & 1) == 0) {
                    ASSERT_EQ(flat.wedge_uv[f][corner(f)], flat.wedge_uv[g][corner(g)]);
                }
            }
        }
        for (std::size_t f = 0; f < raw.faces.size(); ++f) // faces that were turned look mirrored
            ASSERT_GT(signed_area(flat.wedge_uv[f]) * (turned[f] ? -1.0 : 1.0), 0.0);
        host.wedge_uv = flat.wedge_uv;
        const HostResult measures = run("Charts: Measure Flattening", host);
        EXPECT_EQ(value(measures, "flipped_faces_number"), 0);
        EXPECT_EQ(value(measures, "overlapping_faces_number"), 0);
        EXPECT_EQ(value(measures, "charts_number"), value(flat, "charts_number"));
        EXPECT_EQ(sound_charts(measures), value(flat, "charts_number"));
        EXPECT_LT(value(measures, "l2_stretch"), 1.2);
    }
}

TEST(Layout, ALayoutIsInTheUnitSquareAtOneScale) {
    const mesh::RawMesh raw = shapes::moved(noisy_torus(), 30.0, Vec3(100, 0, 0));
    HostMesh host = host_of(raw);
    take_charts(host, run("Segmentation: D-Charts", host));
    for (const bool pack : {true, false}) {
        const HostResult flat = run("Charts: Flatten", host, {{"pack", pack}});
        std::map<int, std::pair<double, double>> areas; // chart → in the plane, on the surface
        double high = 0.0;
        for (std::size_t f = 0; f < raw.faces.size(); ++f) {
            areas[flat.chart_id[f]].first += signed_area(flat.wedge_uv[f]);
            areas[flat.chart_id[f]].second += area_on_surface(raw, f);
            for (const Vec2& p : flat.wedge_uv[f]) {
                EXPECT_GE(p.minCoeff(), 0.0);
                high = std::max(high, p.maxCoeff());
            }
        }
        const double scale = areas.at(0).first / areas.at(0).second;
        for (const auto& [chart, area] : areas)
            EXPECT_NEAR(area.first / area.second, scale, 1e-3 * scale);
        if (pack) {
            EXPECT_LE(high, 1.0);
            EXPECT_GT(high, 0.95);
        } else {
            EXPECT_NEAR(scale, 1.0, 1e-3); // model units
        }
    }
}

TEST(Layout, PackingKeepsShapesAndEvensScales) {
    HostMesh host = host_of(
        shapes::join(shapes::grid(4, 3), shapes::moved(shapes::grid(3, 3), 2.0, Vec3(5, 0, 0))));
    for (std::size_t f = 0; f < host.geometry.faces.size(); ++f) {
        std::array<Vec2, 3> corners;
        for (std::size_t k = 0; k < 3;
             ++k) // the second chart half as large as it should be, turned
            corners[k] =
                f < 24 ? Vec2(host.geometry.points[host.geometry.faces[f][k]].head<2>())
                       : Vec2(0.5 * (Eigen::Rotation2Dd(0.4) *
                                     host.geometry.points[host.geometry.faces[f][k]].head<2>()));
        host.wedge_uv.push_back(corners);
    }
    const HostResult packed = run("Charts: Pack", host);
    EXPECT_EQ(value(packed, "charts_number"), 2);
    const double scale = signed_area(packed.wedge_uv[0]) / area_on_surface(host.geometry, 0);
    for (std::size_t f = 0; f < host.geometry.faces.size(); ++f) {
        EXPECT_NEAR(signed_area(packed.wedge_uv[f]), scale * area_on_surface(host.geometry, f),
                    1e-5 * scale);
        for (const Vec2& p : packed.wedge_uv[f])
            EXPECT_TRUE(p.minCoeff() >= 0.0 && p.maxCoeff() <= 1.0);
    }
    EXPECT_TRUE(packed.chart_id.empty());
}

TEST(Layout, AllMethodsGiveValidLayouts) {
    for (const mesh::RawMesh& raw :
         {noisy_torus(), shapes::moebius_strip(24, 2), shapes::double_torus(),
          shapes::with_noise(shapes::grid(12, 12), 0.1, 4)}) {
        HostMesh host = host_of(raw); // one chart: packed at once
        for (int method = 0; method < 5; ++method) {
            const HostResult flat = run("Charts: Flatten", host, {{"method", method}});
            expect_agreement(raw, flat);
            HostMesh laid = host;
            laid.wedge_uv = flat.wedge_uv;
            const HostResult m = run("Charts: Measure Flattening", laid);
            EXPECT_EQ(value(m, "flipped_faces_number"), 0) << method;
            EXPECT_EQ(value(m, "overlapping_faces_number"), 0) << method;
            EXPECT_EQ(value(m, "charts_number"), value(flat, "charts_number")) << method;
            EXPECT_EQ(sound_charts(m), value(flat, "charts_number")) << method;
        }
    }
}

} // namespace
} // namespace devseg::declare
