// Vertices that are drawn to one place are one, but sheets without thickness keep both sides.
#include "devseg/mesh/empty_edges.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/mesh/input_gate.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::mesh {
namespace {

// Rings of `count` vertices (radius, height), joined one after the other.
RawMesh rings(const std::vector<Vec2>& profile, Index count) {
    RawMesh raw;
    for (const Vec2& p : profile)
        for (Index i = 0; i < count; ++i) {
            const double angle = 2.0 * pi * i / count;
            raw.points.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
        }
    for (Index r = 0; r + 1 < static_cast<Index>(profile.size()); ++r)
        for (Index i = 0; i < count; ++i) {
            const Index a = r * count + i;
            const Index b = r * count + (i + 1) % count;
            raw.faces.push_back({a, b, b + count});
            raw.faces.push_back({a, b + count, a + count});
        }
    return raw;
}

TEST(EmptyEdges, AHoleDrawnToAPointIsClosed) {
    const GatedMesh gated = gate_mesh(rings({{1.0, 0.0}, {0.0, 0.0}}, 16));
    EXPECT_EQ(gated.mesh.face_count(), 16);
    EXPECT_EQ(gated.mesh.vertex_count(), 17);
    EXPECT_TRUE(checks::is_valid(gated.mesh));
}

// Two plates, hung together by a tube without width: its needles lay on the plates, and on each
// other.
TEST(EmptyEdges, PlatesOnATubeWithoutWidthAreFlattenedWithoutOverlaps) {
    for (const Index count : {16, 32}) {
        const RawMesh raw = rings({{1.0, 0.0}, {0.0, 0.0}, {0.0, -0.5}, {0.8, -0.5}}, count);
        EXPECT_EQ(gate_mesh(raw).mesh.face_count(), 2 * count);
        declare::HostMesh host = checks::host_of(raw);
        checks::take_charts(host, checks::run("Segmentation: D-Charts", host));
        const declare::HostResult flat = checks::run("Charts: Flatten", host);
        EXPECT_EQ(checks::value(flat, "charts_number"), 2);
        host.wedge_uv = flat.wedge_uv;
        const declare::HostResult measured = checks::run("Charts: Measure Flattening", host);
        EXPECT_EQ(checks::value(measured, "overlapping_faces_number"), 0);
        EXPECT_EQ(checks::value(measured, "flipped_faces_number"), 0);
        EXPECT_NEAR(checks::value(measured, "l2_stretch"), 1.0, 1e-6);
    }
}

// A cube pressed flat: its sides have no height, and its top lies on its bottom.
TEST(EmptyEdges, SheetsWithoutThicknessKeepBothSides) {
    RawMesh raw = shapes::cube(4);
    for (Vec3& p : raw.points)
        p.z() = 0.0;
    std::vector<Triangle> faces = raw.faces;
    join_ends_of_empty_edges(raw.points, faces);
    double before = 0.0;
    for (const Triangle& t : raw.faces)
        before +=
            (raw.points[t[1]] - raw.points[t[0]]).cross(raw.points[t[2]] - raw.points[t[0]]).norm();
    const GatedMesh gated = gate_mesh(raw);
    EXPECT_NEAR(gated.mesh.total_area * gated.mesh.unit_length * gated.mesh.unit_length,
                0.5 * before, 1e-9);
    EXPECT_TRUE(checks::is_valid(gated.mesh));
}

// A square tube drawn to a line, but for one corner of an end: two triangles back to back, which
// stay two. The needles between them lay on each other.
TEST(EmptyEdges, FacesBetweenSheetsThatStayApartAreLeftOut) {
    RawMesh raw = rings({{0.0, 0.0}, {0.0, -0.5}, {0.0, -1.0}}, 4);
    raw.points[3] = Vec3(0.2, 0.0, 0.0);
    const GatedMesh gated = gate_mesh(raw);
    EXPECT_EQ(gated.source_face, (std::vector<Index>{4, 6}));
    EXPECT_TRUE(checks::is_valid(gated.mesh));
    declare::HostMesh host = checks::host_of(raw);
    checks::take_charts(host, checks::run("Segmentation: D-Charts", host));
    const declare::HostResult flat = checks::run("Charts: Flatten", host);
    host.wedge_uv = flat.wedge_uv;
    const declare::HostResult measured = checks::run("Charts: Measure Flattening", host);
    EXPECT_EQ(checks::value(measured, "overlapping_faces_number"), 0);
    EXPECT_EQ(checks::value(measured, "flipped_faces_number"), 0);
    for (const auto& corners : flat.wedge_uv)
        EXPECT_GT(checks::signed_area(corners), 0.0);
}

// A needle between two faces, at an edge that a third one has: without it, that would be the
// neighbour of the wrong one.
TEST(EmptyEdges, FacesAtCrowdedEdgesStay) {
    RawMesh raw;
    raw.points = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    raw.faces = {{0, 1, 3}, {1, 0, 2}, {2, 0, 4}};
    EXPECT_EQ(gate_mesh(raw).mesh.face_count(), 2);
    raw.faces.push_back({0, 1, 5});
    EXPECT_EQ(gate_mesh(raw).mesh.face_count(), 4);
}

TEST(EmptyEdges, OtherMeshesStayAsTheyAre) {
    const RawMesh raw = shapes::sphere(2);
    std::vector<Triangle> faces = raw.faces;
    EXPECT_EQ(join_ends_of_empty_edges(raw.points, faces), 0);
    EXPECT_EQ(faces, raw.faces);
}

} // namespace
} // namespace devseg::mesh
