// Every flattening method on bad input: a valid layout, or a refusal that names the face.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg {
namespace {

using checks::run;
using checks::sound_charts;
using checks::value;

// In the order of the filter's parameter.
constexpr const char* methods[] = {"Symmetric Dirichlet", "LSCM", "ABF++", "ARAP", "LPFB",
                                   "LPFB Even Areas"};

declare::HostResult flatten(const mesh::RawMesh& raw, int method) {
    return run("Charts: Flatten", checks::host_of(raw), {{"method", method}});
}

// Pairs of faces that share more than rounding, by clipping: independent of the metrics.
Index overlapping_pairs(const std::vector<std::array<Vec2, 3>>& uv) {
    Index count = 0;
    std::vector<Eigen::AlignedBox2d> boxes;
    for (const auto& face : uv) {
        boxes.emplace_back(face[0]);
        boxes.back().extend(face[1]);
        boxes.back().extend(face[2]);
    }
    for (std::size_t i = 0; i < uv.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            if (!boxes[i].intersects(boxes[j]))
                continue;
            const double least = std::min(std::abs(checks::signed_area(uv[i])),
                                          std::abs(checks::signed_area(uv[j])));
            // 32-bit coordinates: what a corner moves by rounding, along a whole edge.
            const double rounding = 1e-7 * (boxes[i].diagonal().norm() + 1e-3);
            count += checks::common_area(uv[i], uv[j]) > 0.01 * least + rounding ? 1 : 0;
        }
    return count;
}

// No face flipped or without area, nothing on top of another thing, all in the unit square.
void expect_valid_layout(const mesh::RawMesh& raw, int method) {
    SCOPED_TRACE(methods[method]);
    const declare::HostResult flat = flatten(raw, method);
    ASSERT_EQ(flat.wedge_uv.size(), raw.faces.size());
    Index flips = 0;
    Eigen::AlignedBox2d box;
    for (const auto& face : flat.wedge_uv) {
        flips += checks::signed_area(face) > 0.0 ? 0 : 1; // and 1 for a NaN
        box.extend(face[0]).extend(face[1]).extend(face[2]);
    }
    EXPECT_TRUE(Eigen::AlignedBox2d(Vec2::Zero(), Vec2::Ones()).contains(box));
    EXPECT_EQ(flips, 0);
    EXPECT_EQ(overlapping_pairs(flat.wedge_uv), 0);
    checks::expect_agreement(raw, flat);
    declare::HostMesh laid = checks::host_of(raw);
    laid.wedge_uv = flat.wedge_uv;
    const declare::HostResult m = run("Charts: Measure Flattening", laid);
    EXPECT_EQ(value(m, "flipped_faces_number"), 0);
    EXPECT_EQ(value(m, "overlapping_faces_number"), 0);
    EXPECT_EQ(sound_charts(m), value(m, "charts_number"));
    EXPECT_EQ(value(m, "charts_number"), value(flat, "charts_number"));
}

void expect_valid_layouts(const mesh::RawMesh& raw) {
    for (int method = 0; method < 5; ++method)
        expect_valid_layout(raw, method);
}

// The packing of several charts takes a fixed effort: here for two methods only.
void expect_valid_layouts_of_parts(const mesh::RawMesh& raw) {
    expect_valid_layout(raw, 0);
    expect_valid_layout(raw, 4);
}

// A square plate of which some faces have no area: vertices on edges, and two on one point.
mesh::RawMesh plate_with_flat_faces() {
    mesh::RawMesh raw = shapes::grid(6, 6);
    const auto split_flat = [&](std::size_t f) { // a vertex in the middle of edge 0 of face f
        const Triangle t = raw.faces[f];
        const auto middle = static_cast<Index>(raw.points.size());
        raw.points.push_back(0.5 * (raw.points[t[0]] + raw.points[t[1]]));
        raw.faces[f] = {middle, t[1], t[2]};
        raw.faces.push_back({t[0], middle, t[2]});
        raw.faces.push_back({t[0], t[1], middle}); // flat, towards the face across the edge
    };
    split_flat(15);
    split_flat(40);
    raw.points[24] = raw.points[25];
    return raw;
}

TEST(BadInput, FacesWithoutArea) {
    expect_valid_layouts(plate_with_flat_faces());
}

TEST(BadInput, Needles) {
    for (const double aspect : {1e3, 1e5}) {
        expect_valid_layouts(shapes::grid(1, 12, 1.0, 12.0 / aspect)); // flat, across
        expect_valid_layouts(shapes::cylinder_tube(12, 1, 1.0, aspect / 2.0));
        expect_valid_layouts(shapes::grid(12, 1, 12.0 / aspect, 1.0)); // flat, along
    }
}

TEST(BadInput, ChartsOfOneTriangle) {
    expect_valid_layouts({{{0, 0, 0}, {5, 1, 2}, {1, 3, -1}}, {{0, 1, 2}}});
    expect_valid_layouts({{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-4, 0}}, {{0, 1, 2}}});
    mesh::RawMesh many;
    for (Index i = 0; i < 4; ++i)
        many = shapes::join(many, shapes::moved({{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 1}}, {{0, 1, 2}}},
                                                1.0 + i, {5.0 * i, 0, 0}));
    expect_valid_layouts_of_parts(many);
    EXPECT_EQ(value(flatten(many, 0), "charts_number"), 4.0);
}

TEST(BadInput, ManyHoles) {
    const mesh::RawMesh plate = shapes::plate(shapes::mask_with_holes(27));
    expect_valid_layouts(plate);
    mesh::RawMesh bent = plate;
    for (Vec3& p : bent.points)
        p.z() = std::sin(0.8 * p.x()) * (0.3 + 0.2 * p.y());
    expect_valid_layouts_of_parts(bent);
}

TEST(BadInput, HandlesAndClosedSurfaces) {
    for (const mesh::RawMesh& raw :
         {shapes::tetrahedron(), shapes::cube(2), shapes::sphere(2), shapes::torus(16, 10),
          shapes::double_torus(), shapes::slab(shapes::mask_with_holes(4)),
          shapes::plate_with_handle()})
        expect_valid_layouts(raw);
}

TEST(BadInput, TinyHugeAndFarAway) {
    const mesh::RawMesh raw = shapes::with_noise(shapes::hemisphere(16, 6), 0.02, 5);
    for (int method = 0; method < 5; ++method) {
        const double energy = value(flatten(raw, method), "worst_chart_energy");
        for (const auto& [scale, place] :
             {std::pair(1e-9, Vec3(0, 0, 0)), {1e9, Vec3(0, 0, 0)}, {1.0, Vec3(1e6, -2e6, 0)}}) {
            const mesh::RawMesh other = shapes::moved(raw, scale, place);
            expect_valid_layout(other, method);
            EXPECT_NEAR(value(flatten(other, method), "worst_chart_energy"), energy, 1e-4 * energy);
        }
    }
}

TEST(BadInput, CoordinatesThatAreNotFiniteAreRefusedWithTheFace) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        for (int method = 0; method < 5; ++method) {
            mesh::RawMesh raw = shapes::grid(4, 4);
            raw.points[raw.faces[30][1]].y() = bad;
            std::vector<Index> expected;
            for (std::size_t f = 0; f < raw.faces.size(); ++f)
                if (std::count(raw.faces[f].begin(), raw.faces[f].end(), raw.faces[30][1]) > 0)
                    expected.push_back(static_cast<Index>(f));
            try {
                flatten(raw, method);
                ADD_FAILURE() << "accepted by " << methods[method];
            } catch (const InvalidMesh& error) {
                EXPECT_EQ(error.faces, expected);
                EXPECT_TRUE(checks::contains(error.what(),
                                             "first face " + std::to_string(expected.front())));
            }
        }
}

TEST(BadInput, TextureCoordinatesThatNoHostHoldsAreRefusedWithTheFace) {
    const declare::HostMesh flat = [] {
        declare::HostMesh host = checks::host_of(shapes::with_noise(shapes::grid(4, 4), 0.05, 1));
        host.wedge_uv = run("Charts: Flatten", host).wedge_uv;
        return host;
    }();
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -1e300, 1e39}) {
        declare::HostMesh host = flat;
        host.wedge_uv[30][1].y() = bad;
        try {
            run("Pattern: Sewn Preview", host);
            ADD_FAILURE() << "accepted " << bad;
        } catch (const InvalidMesh& error) {
            EXPECT_EQ(error.faces, std::vector<Index>{30});
        }
    }
    declare::HostMesh host = flat;
    host.wedge_uv[30][1].y() = std::numeric_limits<float>::max();
    EXPECT_NO_THROW(run("Pattern: Sewn Preview", host));
}

// The needles at the collapsed edge can only be opened to wide angles: maps thousands of times as
// large as the model are of no use.
TEST(BadInput, ATetrahedronWithACollapsedEdgeStaysSmall) {
    for (const Vec3& way : {Vec3(0, 0, 1), Vec3(1, -4, 0), Vec3(2, 1, 0)}) {
        mesh::RawMesh raw;
        raw.points = {{0, 0, 0}, 1e-11 * way, {0.28, 0, 0}, {0.2, 0.29, 0}};
        raw.faces = {{0, 1, 2}, {1, 3, 2}, {0, 3, 1}, {0, 2, 3}};
        for (int method = 0; method < 5; ++method) {
            SCOPED_TRACE(methods[method]);
            const declare::HostResult flat =
                run("Charts: Flatten", checks::host_of(raw), {{"method", method}, {"pack", false}});
            for (const auto& corners : flat.wedge_uv)
                for (const Vec2& p : corners)
                    EXPECT_LT(p.norm(), 10.0);
        }
        expect_valid_layout(raw, 0);
    }
}

TEST(BadInput, AFoldedBackStripAndABowtie) {
    // Two squares that touch in one vertex, and a strip folded onto itself in space.
    mesh::RawMesh bowtie =
        shapes::join(shapes::grid(3, 3), shapes::moved(shapes::grid(3, 3), 1.0, {1.0, 1.0, 0.0}));
    const Index corner = 15; // (1, 1) of the first, and corner 0 of the second
    for (Triangle& t : bowtie.faces)
        std::replace(t.begin(), t.end(), Index{16}, corner);
    expect_valid_layouts_of_parts(bowtie);
    expect_valid_layouts(shapes::folded_strip(12, 3, 0.95 * shapes::pi));
}

} // namespace
} // namespace devseg
