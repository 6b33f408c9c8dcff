// What the gate does not let through, and what it says.
#include <limits>

#include <gtest/gtest.h>

#include "devseg/mesh/input_gate.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::mesh {
namespace {

using checks::contains;
using checks::error_of;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<Index> refused_faces(const RawMesh& raw) {
    try {
        gate_mesh(raw);
    } catch (const InvalidMesh& error) {
        return error.faces;
    }
    ADD_FAILURE() << "the mesh was accepted";
    return {};
}

std::string refusal(const RawMesh& raw) {
    return error_of<InvalidMesh>([&] { gate_mesh(raw); });
}

TEST(GateRefusals, NoFaces) {
    EXPECT_TRUE(contains(refusal({}), "0 vertices and no faces"));
    EXPECT_TRUE(contains(refusal({{Vec3::Zero()}, {}}), "1 vertex and no faces"));
    EXPECT_TRUE(contains(refusal({shapes::cube(1).points, {}}), "Screened Poisson"));
}

TEST(GateRefusals, IndexOutOfRange) {
    for (const Index bad : {4, -1, std::numeric_limits<Index>::max()}) {
        RawMesh raw = shapes::tetrahedron();
        raw.faces[2][1] = bad;
        const std::string text = refusal(raw);
        EXPECT_TRUE(contains(text, "from 0 to 3"));
        EXPECT_TRUE(contains(text, "found " + std::to_string(bad) + " in face 2"));
        EXPECT_EQ(refused_faces(raw), std::vector<Index>{2});
    }
}

TEST(GateRefusals, CoordinatesThatAreNotFinite) {
    for (const double bad : {nan, infinity, -infinity})
        for (int axis = 0; axis < 3; ++axis) {
            RawMesh raw = shapes::tetrahedron();
            raw.points[3][axis] = bad;
            EXPECT_TRUE(contains(refusal(raw), "at vertex 3 (3 faces affected, first face 1)"));
            EXPECT_EQ(refused_faces(raw), (std::vector<Index>{1, 2, 3}));
        }
}

TEST(GateRefusals, NoSize) {
    const Vec3 p(3.0, 4.0, 5.0);
    EXPECT_TRUE(contains(refusal({{p, p, p}, {{0, 1, 2}}}), "all vertices at one point"));
}

TEST(GateRefusals, TooLargeToMeasure) {
    RawMesh raw = shapes::tetrahedron();
    raw.points[0] = Vec3(1.7e308, 0.0, 0.0);
    raw.points[1] = Vec3(-1.7e308, 0.0, 0.0);
    EXPECT_TRUE(contains(refusal(raw), "too large"));
}

TEST(GateRefusals, NoArea) {
    // Two faces of four points on a line, and one that repeats a vertex.
    const RawMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {4, 4, 4}}, {{0, 1, 2}, {1, 3, 2}}};
    EXPECT_TRUE(contains(refusal(line), "2 faces without any area"));
    EXPECT_TRUE(contains(refusal({{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}}}), "without any area"));
}

} // namespace
} // namespace devseg::mesh
