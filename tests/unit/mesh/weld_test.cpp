// Vertices at the same place: which become one on the way through the gate.
#include "devseg/mesh/weld.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "devseg/mesh/input_gate.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::mesh {
namespace {

using checks::contains;
using checks::is_valid;

// Every face with three vertices of its own.
RawMesh soup(const RawMesh& mesh) {
    RawMesh apart;
    for (const Triangle& t : mesh.faces) {
        const auto first = static_cast<Index>(apart.points.size());
        for (const Index v : t)
            apart.points.push_back(mesh.points[v]);
        apart.faces.push_back({first, first + 1, first + 2});
    }
    return apart;
}

// A vertex for each normal, as glTF has it: the flat sides of a cube share no vertices.
RawMesh flat_shaded_cube(Index cells) {
    const RawMesh cube = shapes::cube(cells);
    RawMesh apart;
    std::vector<std::vector<Index>> own(cube.points.size(), std::vector<Index>(6, -1));
    for (const Triangle& t : cube.faces) {
        const Vec3 normal =
            (cube.points[t[1]] - cube.points[t[0]]).cross(cube.points[t[2]] - cube.points[t[0]]);
        Vec3::Index axis = 0;
        normal.cwiseAbs().maxCoeff(&axis);
        const std::size_t side = static_cast<std::size_t>(axis) + (normal[axis] > 0.0 ? 3 : 0);
        Triangle corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            Index& v = own[t[k]][side];
            if (v < 0) {
                v = static_cast<Index>(apart.points.size());
                apart.points.push_back(cube.points[t[k]]);
            }
            corners[k] = v;
        }
        apart.faces.push_back(corners);
    }
    return apart;
}

Index open_edges(const Mesh& mesh) {
    return static_cast<Index>(std::count(mesh.twin.begin(), mesh.twin.end(), -1));
}

Index solids(const Mesh& mesh) {
    EXPECT_TRUE(is_valid(mesh));
    EXPECT_EQ(open_edges(mesh), 0);
    return checks::components(mesh).count;
}

TEST(Weld, AVertexForEachNormalIsOneVertex) {
    const RawMesh split = flat_shaded_cube(3);
    ASSERT_EQ(split.points.size(), 6U * 16U);
    const GatedMesh gated = gate_mesh(split);
    EXPECT_EQ(solids(gated.mesh), 1);
    EXPECT_EQ(gated.mesh.points.size(), 56U);
    ASSERT_EQ(gated.notes.size(), 1U);
    EXPECT_TRUE(contains(gated.notes[0], "40 vertices were joined with others at the same place"));
    // The faces are those of the file, and know its vertices: the first at each place.
    for (const Face f : gated.mesh.all_faces())
        for (Index k = 0; k < 3; ++k) {
            const Index source = split.faces[gated.source_face[f]][gated.source_corner(f, k)];
            const Index first = gated.source_vertex[gated.mesh.faces[f][k]];
            EXPECT_LE(first, source);
            EXPECT_EQ(split.points[first], split.points[source]);
        }
}

TEST(Weld, ASoupOfTrianglesIsASurfaceAgain) {
    const RawMesh ball = shapes::sphere(2);
    const GatedMesh gated = gate_mesh(soup(ball));
    EXPECT_EQ(solids(gated.mesh), 1);
    EXPECT_EQ(gated.mesh.points.size(), ball.points.size());
}

TEST(Weld, TrianglesOfTheirOwnCloseTheHolesOfAMesh) {
    RawMesh ball = shapes::sphere(2);
    const RawMesh lids = soup({ball.points, {ball.faces[10], ball.faces[50], ball.faces[51]}});
    for (const std::ptrdiff_t f : {51, 50, 10})
        ball.faces.erase(ball.faces.begin() + f);
    EXPECT_EQ(solids(gate_mesh(shapes::join(ball, lids)).mesh), 1);
}

TEST(Weld, MeshesWithoutCutsStayAsTheyAre) {
    const RawMesh plane = shapes::grid(3, 3, 1.0, 1.0);
    const GatedMesh gated = gate_mesh(plane);
    EXPECT_EQ(gated.mesh.faces, plane.faces);
    EXPECT_TRUE(gated.notes.empty());
}

TEST(Weld, SolidsThatTouchStaySolids) {
    // Side by side with a common edge, with a common side, and edge on edge across a corner.
    for (const Vec3& offset : {Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 1, 1)})
        for (const Index cells : {1, 2})
            for (const bool triangles : {false, true}) {
                const RawMesh cube =
                    triangles ? soup(shapes::cube(cells)) : flat_shaded_cube(cells);
                const GatedMesh gated =
                    gate_mesh(shapes::join(cube, shapes::moved(cube, 1.0, offset)));
                SCOPED_TRACE(offset.transpose());
                if (triangles && offset == Vec3(1, 0, 0))
                    continue; // the triangles of the common side are duplicates in a soup
                EXPECT_EQ(solids(gated.mesh), 2) << cells << triangles;
                EXPECT_EQ(gated.notes.size(), 1U);
            }
}

TEST(Weld, ASheetThatTouchesASolidStaysASheet) {
    const RawMesh cube = flat_shaded_cube(1);
    RawMesh sheet; // goes on from the top of the cube
    sheet.points = {{0, 0, 1}, {0, 1, 1}, {-1, 1, 1}, {-1, 0, 1}};
    sheet.faces = {{0, 1, 2}, {0, 2, 3}};
    for (const RawMesh& other : {sheet, shapes::turned_over(sheet)}) {
        const Mesh mesh = gate_mesh(shapes::join(cube, other)).mesh;
        EXPECT_TRUE(is_valid(mesh));
        EXPECT_EQ(checks::components(mesh).count, 2);
        EXPECT_EQ(open_edges(mesh), 4); // those of the sheet
    }
}

TEST(Weld, ThreeSheetsOnOneEdgeStayApart) {
    RawMesh fins;
    fins.points = {{0, 0, 0},   {0, 0, 1}, {1, 0, 0},  {-1, 1, 0},
                   {-1, -1, 0}, {2, 0, 0}, {-2, 2, 0}, {-2, -2, 0}};
    fins.faces = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
    const RawMesh apart = soup(fins);
    // Each with a second triangle, so that it is a sheet.
    RawMesh sheets = apart;
    for (const Index s : {0, 1, 2}) {
        sheets.points.push_back(fins.points[5 + s]);
        const Triangle& t = apart.faces[s];
        sheets.faces.push_back({t[2], t[1], static_cast<Index>(sheets.points.size()) - 1});
    }
    const GatedMesh gated = gate_mesh(sheets);
    EXPECT_EQ(gated.mesh.points.size(), sheets.points.size());
    EXPECT_TRUE(gated.notes.empty());
    EXPECT_EQ(gate_mesh(apart).mesh.points.size(), 9U);
}

TEST(Weld, LayersOnEachOtherStayApart) {
    const RawMesh front = shapes::grid(2, 2, 1.0, 1.0);
    // The same points; the same diagonals as triangles of the front, and the other ones.
    RawMesh back = shapes::turned_over(front);
    for (const bool other_diagonals : {false, true}) {
        if (other_diagonals)
            for (std::size_t f = 0; f + 1 < back.faces.size(); f += 2) {
                std::vector<Index> four;
                for (const Index v : back.faces[f])
                    if (std::count(back.faces[f + 1].begin(), back.faces[f + 1].end(), v) == 0)
                        four.push_back(v);
                ASSERT_EQ(four.size(), 1U);
                const auto apex = std::find(back.faces[f].begin(), back.faces[f].end(), four[0]);
                const std::size_t k = static_cast<std::size_t>(apex - back.faces[f].begin());
                const Index next = back.faces[f][(k + 1) % 3];
                const Index last = back.faces[f][(k + 2) % 3];
                Index far = -1;
                for (const Index v : back.faces[f + 1])
                    far = v != next && v != last ? v : far;
                back.faces[f] = {four[0], next, far};
                back.faces[f + 1] = {four[0], far, last};
            }
        const RawMesh leaf = shapes::join(front, back);
        const GatedMesh gated = gate_mesh(leaf);
        EXPECT_EQ(gated.mesh.points.size(), leaf.points.size());
        EXPECT_TRUE(gated.notes.empty());
    }
}

TEST(Weld, BordersThatRunAlikeStayApart) {
    const RawMesh left = shapes::grid(2, 2, 1.0, 1.0);
    const RawMesh right = shapes::moved(left, 1.0, Vec3(1, 0, 0));
    EXPECT_EQ(gate_mesh(shapes::join(left, right)).mesh.points.size(), 15U);
    EXPECT_EQ(gate_mesh(shapes::join(left, shapes::turned_over(right))).mesh.points.size(), 18U);
}

TEST(Weld, ATolerantGateJoinsWhatIsNear) {
    const RawMesh left = shapes::grid(8, 8, 1.0, 1.0);
    const RawMesh right = shapes::with_noise(shapes::moved(left, 1.0, Vec3(1, 0, 0)), 1e-5, 7);
    const RawMesh both = shapes::moved(shapes::join(left, right), 300.0, Vec3(5, 5, 5));
    EXPECT_EQ(gate_mesh(both).mesh.points.size(), 162U);
    EXPECT_EQ(gate_mesh(both, {1e-6, false}).mesh.points.size(), 162U);
    const GatedMesh joined = gate_mesh(both, {1e-4, false});
    EXPECT_TRUE(is_valid(joined.mesh));
    EXPECT_EQ(joined.mesh.points.size(), 153U);
    EXPECT_TRUE(contains(joined.notes.at(0), "9 vertices were joined with others nearby"));
}

TEST(Weld, WhatIsNotJoinedCountsAsCut) {
    const RawMesh split = flat_shaded_cube(2);
    const GatedMesh gated = gate_mesh(split, {-1.0, false});
    EXPECT_EQ(gated.mesh.points.size(), split.points.size());
    EXPECT_TRUE(gated.notes.empty());
    for (const HalfEdge h : gated.mesh.all_half_edges())
        EXPECT_EQ(gated.cut[h] != 0, gated.mesh.twin[h] < 0);
    EXPECT_EQ(gate_mesh(soup(shapes::sphere(1)), {-1.0, false}).mesh.points.size(), 240U);
}

TEST(InsideOut, ClosedSurfacesAreNotedAndTurnedWherePatternsAreMade) {
    const RawMesh ball = shapes::sphere(2);
    const RawMesh both =
        shapes::join(shapes::turned_over(ball), shapes::moved(ball, 1.0, Vec3(3, 0, 0)));
    const GatedMesh as_it_is = gate_mesh(both);
    EXPECT_EQ(as_it_is.mesh.faces, both.faces);
    ASSERT_EQ(as_it_is.notes.size(), 1U);
    EXPECT_TRUE(contains(as_it_is.notes[0], "1 closed surface is inside out"));
    const GatedMesh turned = gate_mesh(both, {0.0, true});
    EXPECT_TRUE(is_valid(turned.mesh));
    EXPECT_TRUE(contains(turned.notes.at(0), "read turned over"));
    for (const Face f : turned.mesh.all_faces()) {
        const bool first = at(f) < ball.faces.size();
        EXPECT_EQ(turned.flipped[f] != 0, first);
        const Vec3 middle = turned.mesh.face_centers[f] * turned.mesh.unit_length + turned.center;
        EXPECT_GT(turned.mesh.face_normals[f].dot(middle - (first ? Vec3(0, 0, 0) : Vec3(3, 0, 0))),
                  0.0);
    }
}

TEST(InsideOut, WallsOfCavitiesAndOpenSurfacesAreAsTheyShouldBe) {
    const RawMesh ball = shapes::sphere(2);
    const RawMesh hollow =
        shapes::join(ball, shapes::turned_over(shapes::moved(ball, 0.5, Vec3::Zero())));
    for (const RawMesh& raw : {hollow, shapes::turned_over(shapes::hemisphere(12, 4)),
                               shapes::join(shapes::grid(2, 2), shapes::grid(2, 2))}) {
        const GatedMesh gated = gate_mesh(raw, {0.0, true});
        EXPECT_TRUE(gated.notes.empty());
        EXPECT_EQ(gated.mesh.faces, raw.faces);
    }
}

} // namespace
} // namespace devseg::mesh
