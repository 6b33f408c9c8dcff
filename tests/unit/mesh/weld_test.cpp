// Borders that lie on each other.
#include "devseg/mesh/weld.h"

#include <gtest/gtest.h>

#include "unit/shapes.h"

namespace devseg::mesh {
namespace {

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

TEST(Weld, ASoupOfTrianglesIsASurfaceAgain) {
    const RawMesh ball = shapes::sphere(2);
    const WeldedMesh welded = weld_borders(soup(ball));
    EXPECT_EQ(welded.edges, static_cast<Index>(3 * ball.faces.size() / 2));
    const Mesh mesh = gate_mesh(welded.mesh).mesh;
    for (const Index twin : mesh.twin)
        EXPECT_GE(twin, 0);
    EXPECT_EQ(mesh.points.size(), ball.points.size());
}

TEST(Weld, MeshesWithoutCutsStayAsTheyAre) {
    const RawMesh plane = shapes::grid(3, 3, 1.0, 1.0);
    const WeldedMesh welded = weld_borders(plane);
    EXPECT_EQ(welded.edges, 0);
    EXPECT_EQ(welded.mesh.faces, plane.faces);
}

TEST(Weld, ThreeBordersOnOneEdgeStayApart) {
    RawMesh fins;
    fins.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    fins.faces = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    EXPECT_EQ(weld_borders(soup(fins)).edges, 0);
}

TEST(Weld, LayersOnEachOtherStayApart) {
    RawMesh sheet = shapes::grid(1, 1, 1.0, 1.0);
    const auto points = sheet.points;
    const auto faces = sheet.faces;
    const auto count = static_cast<Index>(points.size());
    sheet.points.insert(sheet.points.end(), points.begin(), points.end());
    for (const Triangle& t : faces)
        sheet.faces.push_back({t[0] + count, t[2] + count, t[1] + count});
    const WeldedMesh welded = weld_borders(sheet);
    EXPECT_EQ(welded.edges, 0);
    EXPECT_EQ(welded.mesh.faces, sheet.faces);
}

} // namespace
} // namespace devseg::mesh
