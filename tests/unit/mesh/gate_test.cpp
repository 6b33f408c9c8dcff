#include "devseg/mesh/input_gate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::mesh {
namespace {

using checks::contains;
using checks::is_valid;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double signed_volume(const Mesh& mesh) {
    double sum = 0.0;
    for (const Triangle& t : mesh.faces)
        sum += mesh.points[t[0]].cross(mesh.points[t[1]]).dot(mesh.points[t[2]]) / 6.0;
    return sum;
}

Index cut_edges(const GatedMesh& gated) {
    return static_cast<Index>(std::count(gated.cut.begin(), gated.cut.end(), 1));
}

std::string only_note(const GatedMesh& gated) {
    EXPECT_EQ(gated.notes.size(), 1U);
    return gated.notes.empty() ? "" : gated.notes.front();
}

// The way back: each corner and edge lies where the source has it.
void expect_way_back(const RawMesh& raw, const GatedMesh& gated) {
    const Mesh& mesh = gated.mesh;
    for (const Face f : mesh.all_faces())
        for (Index k = 0; k < 3; ++k) {
            const Triangle& source = raw.faces[gated.source_face[f]];
            const Index v = mesh.faces[f][k];
            ASSERT_EQ(source[gated.source_corner(f, k)], gated.source_vertex[v]);
            const Index w = mesh.faces[f][(k + 1) % 3];
            const std::size_t e = at(gated.source_edge(f, k));
            const std::set<Index> ends = {gated.source_vertex[v], gated.source_vertex[w]};
            const std::set<Index> source_ends = {source[e], source[(e + 1) % 3]};
            ASSERT_EQ(ends, source_ends);
        }
}

TEST(Gate, ValidMeshesGoThroughUnchanged) {
    for (const RawMesh& raw :
         {shapes::grid(3, 2), shapes::cylinder_tube(8, 3), shapes::sphere(2), shapes::torus(8, 6),
          shapes::double_torus(), shapes::cube(2), shapes::tetrahedron(),
          shapes::annulus(9, 2, 1, 2), shapes::plate_with_handle(), shapes::cone(7, 2),
          shapes::hemisphere(8, 3)}) {
        const GatedMesh gated = gate_mesh(raw);
        EXPECT_TRUE(is_valid(gated.mesh));
        EXPECT_EQ(gated.notes, std::vector<std::string>());
        EXPECT_EQ(gated.mesh.faces, raw.faces);
        EXPECT_EQ(cut_edges(gated), 0);
        for (std::size_t f = 0; f < raw.faces.size(); ++f)
            ASSERT_EQ(gated.stand_in[f], static_cast<Index>(f));
    }
}

TEST(Gate, SizeAndPlaceDoNotMatter) {
    const RawMesh raw = shapes::with_noise(shapes::torus(12, 9), 0.1, 7);
    const Mesh reference = checks::gated(raw);
    for (const double scale : {1e-9, 1.0, 1e9})
        for (const double place : {0.0, 1e3}) {
            const Mesh mesh =
                checks::gated(shapes::moved(raw, scale, place * scale * Vec3(1.0, -2.0, 3.0)));
            // Internal coordinates differ by the factor that the power of two leaves over.
            const double factor = reference.unit_length * scale / mesh.unit_length;
            EXPECT_GT(factor, 0.5);
            EXPECT_LT(factor, 2.0);
            int exponent = 0;
            EXPECT_EQ(std::frexp(mesh.unit_length, &exponent), 0.5);
            for (std::size_t v = 0; v < mesh.points.size(); ++v) {
                ASSERT_LE((mesh.points[v] - factor * reference.points[v]).norm(), 1e-11);
                ASSERT_LE(mesh.points[v].cwiseAbs().maxCoeff(), 1.0);
            }
            EXPECT_NEAR(mesh.total_area, factor * factor * reference.total_area, 1e-9);
        }
    const Mesh doubled = checks::gated(shapes::moved(raw, std::ldexp(1.0, 40), Vec3::Zero()));
    EXPECT_EQ(doubled.points, reference.points); // powers of two change no digit
}

TEST(Gate, UnusedPointsAreDropped) {
    RawMesh raw = shapes::tetrahedron();
    raw.points.insert(raw.points.begin(), Vec3(nan, 1e300, infinity));
    raw.points.emplace_back(1e9, 0.0, 0.0);
    for (Triangle& t : raw.faces)
        for (Index& v : t)
            ++v;
    const GatedMesh gated = gate_mesh(raw);
    EXPECT_EQ(gated.source_vertex, (std::vector<Index>{1, 2, 3, 4}));
    EXPECT_EQ(gated.mesh.points, checks::gated(shapes::tetrahedron()).points);
}

TEST(Gate, FacesThatRepeatAVertexAreLeftOut) {
    RawMesh raw = shapes::grid(2, 1); // 4 faces, 6 vertices
    raw.faces.insert(raw.faces.begin() + 1, Triangle{5, 5, 2});
    raw.faces.push_back({2, 2, 2});
    const GatedMesh gated = gate_mesh(raw);
    EXPECT_TRUE(is_valid(gated.mesh));
    EXPECT_EQ(gated.source_face, (std::vector<Index>{0, 2, 3, 4}));
    EXPECT_TRUE(contains(only_note(gated), "2 faces repeat a vertex"));
    for (const std::size_t left_out : {1U, 5U}) { // a face at one of its vertices stands in
        const Index stand_in = gated.stand_in[left_out];
        ASSERT_GE(stand_in, 0);
        const Triangle& t = raw.faces[gated.source_face[stand_in]];
        const Triangle& missing = raw.faces[left_out];
        EXPECT_TRUE(std::find_first_of(t.begin(), t.end(), missing.begin(), missing.end()) !=
                    t.end());
    }
}

TEST(Gate, DuplicateFacesAreLeftOut) {
    RawMesh raw = shapes::tetrahedron();                    // face 1 is (0, 2, 3)
    raw.faces.push_back({2, 3, 0});                         // the same, rotated
    raw.faces.insert(raw.faces.begin(), Triangle{3, 2, 0}); // the same, turned over
    const GatedMesh gated = gate_mesh(raw);
    EXPECT_TRUE(is_valid(gated.mesh));
    EXPECT_EQ(gated.source_face, (std::vector<Index>{0, 1, 3, 4}));
    EXPECT_EQ(gated.stand_in, (std::vector<Index>{0, 1, 0, 2, 3, 0}));
    EXPECT_EQ(gated.notes.size(), 2U); // the turned face was the first, and so it was kept
    EXPECT_TRUE(contains(gated.notes.at(0), "2 faces lie on the vertices of another one"));
    EXPECT_TRUE(contains(gated.notes.at(1), "1 face was read with the orientation"));
    EXPECT_EQ(checks::topology(gated.mesh, checks::components(gated.mesh), 0).euler, 2);
}

TEST(Gate, AFaceWithoutAnyNeighbourHasAStandIn) {
    RawMesh raw = shapes::tetrahedron();
    raw.points.emplace_back(5, 5, 5);
    raw.faces.push_back({4, 4, 4});
    EXPECT_EQ(gate_mesh(raw).stand_in.at(4), 0);
}

// Exporters leave them behind: a face whose corners lie on one line, and one in a point.
TEST(Gate, PartsWithoutAreaAreLeftOut) {
    RawMesh raw = shapes::grid(2, 1); // 4 faces, 6 vertices
    for (const double x : {5.0, 6.0, 8.0})
        raw.points.emplace_back(x, x, 0.0);
    for (int i = 0; i < 3; ++i)
        raw.points.emplace_back(7.0, 0.0, 0.0);
    for (const double y : {0.0, 1.0, 1e-4})
        raw.points.emplace_back(9.0 + (y == 1.0 ? 1.0 : 0.0), y, 0.0); // narrow, but no line
    raw.faces.insert(raw.faces.begin(), Triangle{6, 7, 8});
    raw.faces.push_back({9, 10, 11});
    raw.faces.push_back({12, 13, 14});
    const GatedMesh gated = gate_mesh(raw, {-1.0, false});
    EXPECT_TRUE(is_valid(gated.mesh));
    EXPECT_EQ(gated.source_face, (std::vector<Index>{1, 2, 3, 4, 6}));
    EXPECT_EQ(gated.mesh.vertex_count(), 9);
    EXPECT_EQ(only_note(gated), "2 faces belong to parts without area and were left out");
    expect_way_back(raw, gated);
    // The sliver beside a face with an area stays: its edges are those of its neighbour.
    raw = shapes::grid(2, 2);
    raw.points[4] = raw.points[3];
    EXPECT_EQ(gate_mesh(raw, {-1.0, false}).mesh.faces.size(), raw.faces.size());
}

// Sides of a needle lie on each other: their areas say less than how far its vertices are apart.
TEST(Gate, NeedlesAreAsNarrowAsTheyAre) {
    const auto faces_with = [](double width, bool is_open) {
        RawMesh raw = shapes::grid(2, 1);
        raw.points.insert(raw.points.end(),
                          {{5, 0, 0}, {6, 0, 0}, {5.3, width, 0}, {5.7, 0, width}});
        raw.faces.insert(raw.faces.end(), {{6, 8, 7}, {6, 7, 9}, {6, 9, 8}});
        if (!is_open)
            raw.faces.push_back({7, 8, 9});
        return gate_mesh(raw).mesh.face_count();
    };
    const double size = 6.0;
    for (const bool is_open : {false, true}) {
        EXPECT_EQ(faces_with(0.9e-6 * size, is_open), 4);
        EXPECT_EQ(faces_with(2.2e-6 * size, is_open), is_open ? 7 : 8);
    }
}

TEST(Gate, EdgesWithThreeFacesAreCut) {
    const RawMesh fins = {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                          {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
    const GatedMesh gated = gate_mesh(fins);
    EXPECT_TRUE(is_valid(gated.mesh));
    EXPECT_EQ(gated.cut, (std::vector<std::uint8_t>{1, 0, 0, 1, 0, 0, 1, 0, 0}));
    EXPECT_EQ(gated.mesh.twin, std::vector<HalfEdge>(9, -1));
    EXPECT_EQ(gated.mesh.vertex_count(), 9); // each fin on its own
    EXPECT_TRUE(contains(only_note(gated), "1 edge has more than two faces"));
    expect_way_back(fins, gated);
}

TEST(Gate, VerticesWhereFansTouchAreSplit) {
    const RawMesh flat_bow = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}},
                              {{0, 1, 2}, {0, 3, 4}}};
    const GatedMesh gated = gate_mesh(flat_bow);
    EXPECT_TRUE(is_valid(gated.mesh));
    EXPECT_EQ(gated.mesh.vertex_count(), 6);
    EXPECT_EQ(std::count(gated.source_vertex.begin(), gated.source_vertex.end(), 0), 2);
    EXPECT_TRUE(contains(only_note(gated), "1 vertex joins fans"));

    // Two closed surfaces that share a vertex.
    RawMesh tips = shapes::join(shapes::tetrahedron(),
                                shapes::moved(shapes::tetrahedron(), -1.0, Vec3(2, 2, 2)));
    for (std::size_t f = 4; f < 8; ++f)
        for (Index& v : tips.faces[f])
            v = v == 4 ? 0 : v;
    const GatedMesh twins = gate_mesh(tips);
    EXPECT_TRUE(is_valid(twins.mesh));
    EXPECT_EQ(twins.mesh.vertex_count(), 8);
    EXPECT_EQ(checks::components(twins.mesh).count, 2);
    expect_way_back(tips, twins);
}

TEST(Gate, AMoebiusStripIsCutAcross) {
    // The faces form one ring, in which a single edge has to give way.
    const RawMesh thin = shapes::moebius_strip(20);
    const GatedMesh gated = gate_mesh(thin);
    EXPECT_TRUE(is_valid(gated.mesh));
    EXPECT_EQ(cut_edges(gated), 2);
    EXPECT_TRUE(contains(gated.notes.back(), "1 edge of a one-sided surface was cut"));
    expect_way_back(thin, gated);

    const RawMesh wide = shapes::moebius_strip(20, 4);
    const GatedMesh wide_gated = gate_mesh(wide);
    EXPECT_TRUE(is_valid(wide_gated.mesh));
    EXPECT_GE(cut_edges(wide_gated), 2 * 4);
    EXPECT_EQ(checks::components(wide_gated.mesh).count, 1);
    expect_way_back(wide, wide_gated);
}

TEST(Gate, MixedOrientationsAreRestored) {
    const RawMesh raw = shapes::sphere(2);
    const double volume = signed_volume(checks::gated(raw));
    EXPECT_GT(volume, 0.0);
    for (std::uint32_t seed = 1; seed < 6; ++seed) {
        RawMesh mixed = raw;
        const std::vector<Index> order = shapes::random_order(raw.faces.size(), seed);
        for (std::size_t i = 0; i < order.size() * 2 / 5; ++i) // a minority
            std::swap(mixed.faces[order[i]][1], mixed.faces[order[i]][2]);
        const GatedMesh gated = gate_mesh(mixed);
        EXPECT_TRUE(is_valid(gated.mesh));
        EXPECT_NEAR(signed_volume(gated.mesh), volume, 1e-12);
        EXPECT_TRUE(contains(only_note(gated), std::to_string(order.size() * 2 / 5) +
                                                   " faces were read with the orientation"));
        expect_way_back(mixed, gated);
    }
}

TEST(Gate, InsideOutStaysInsideOut) {
    const RawMesh raw = shapes::turned_over(shapes::sphere(1));
    const GatedMesh gated = gate_mesh(raw);
    EXPECT_LT(signed_volume(gated.mesh), 0.0);
    EXPECT_EQ(gated.mesh.faces, raw.faces);
    EXPECT_TRUE(contains(only_note(gated), "1 closed surface is inside out"));
}

TEST(Gate, EveryComponentKeepsItsOwnMajority) {
    const RawMesh raw = shapes::join(shapes::sphere(1), shapes::turned_over(shapes::sphere(1)));
    EXPECT_EQ(gate_mesh(raw).mesh.faces, raw.faces);
}

TEST(Gate, SeparateTrianglesAreJoinedAgain) {
    const RawMesh sphere = shapes::sphere(2);
    RawMesh soup;
    for (const Triangle& t : sphere.faces) {
        for (const Index v : t)
            soup.points.push_back(sphere.points[v]);
        const Index count = static_cast<Index>(soup.points.size());
        soup.faces.push_back({count - 3, count - 2, count - 1});
    }
    const GatedMesh gated = gate_mesh(soup);
    ASSERT_TRUE(is_valid(gated.mesh));
    EXPECT_EQ(gated.mesh.points.size(), sphere.points.size());
    EXPECT_EQ(std::count(gated.mesh.twin.begin(), gated.mesh.twin.end(), -1), 0);
    ASSERT_EQ(gated.notes.size(), 1U);
    EXPECT_TRUE(contains(gated.notes[0], "Merge Close Vertices"));
    // Two sheets that touch are two where their own faces share vertices.
    const RawMesh sheet = shapes::grid(3, 3);
    EXPECT_EQ(gate_mesh(shapes::join(sheet, sheet)).mesh.points.size(), 32U);
    // One face more on vertices of its own changes nothing about a mesh either.
    const RawMesh two = shapes::join(sheet, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 1}}, {{0, 1, 2}}});
    EXPECT_EQ(gate_mesh(two).mesh.points.size(), 19U);
}

// Random triangles on few vertices break every rule at once.
TEST(Gate, RandomSoupsBecomeManifold) {
    for (std::uint32_t seed = 1; seed <= 300; ++seed) {
        shapes::Random random(seed);
        RawMesh soup;
        const Index vertices = 4 + random.below(12);
        for (Index v = 0; v < vertices; ++v)
            soup.points.push_back(random.direction());
        for (Index f = 3 + random.below(60); f > 0; --f)
            soup.faces.push_back(
                {random.below(vertices), random.below(vertices), random.below(vertices)});
        soup.faces.push_back({0, 1, 2});
        const GatedMesh gated = gate_mesh(soup);
        ASSERT_TRUE(is_valid(gated.mesh)) << "seed " << seed;
        expect_way_back(soup, gated);
        // Left out: exactly the repeated vertices and the later ones of equal vertex sets.
        std::set<std::set<Index>> seen;
        std::vector<Index> kept;
        for (std::size_t f = 0; f < soup.faces.size(); ++f) {
            const std::set<Index> corners(soup.faces[f].begin(), soup.faces[f].end());
            if (corners.size() == 3 && seen.insert(corners).second)
                kept.push_back(static_cast<Index>(f));
        }
        ASSERT_EQ(gated.source_face, kept) << "seed " << seed;
        for (const Index stand_in : gated.stand_in)
            ASSERT_TRUE(stand_in >= 0 && stand_in < gated.mesh.face_count());
        // Edges of two faces stay joined unless they are reported as cut; all others are open.
        std::map<std::set<Index>, Index> uses;
        for (const Index f : kept)
            for (std::size_t k = 0; k < 3; ++k)
                ++uses[{soup.faces[f][k], soup.faces[f][(k + 1) % 3]}];
        for (const HalfEdge h : gated.mesh.all_half_edges()) {
            const Index faces = uses.at({gated.source_vertex[gated.mesh.origin(h)],
                                         gated.source_vertex[gated.mesh.target(h)]});
            ASSERT_EQ(gated.mesh.twin[h] >= 0, faces == 2 && gated.cut[h] == 0);
            ASSERT_TRUE(faces < 3 || gated.cut[h] == 1);
            ASSERT_TRUE(faces > 1 || gated.cut[h] == 0);
        }
    }
}

TEST(Gate, FacesWithoutAreaTakeTheNormalOfTheirNeighbours) {
    RawMesh raw = shapes::grid(2, 2);
    raw.points[4] = raw.points[3]; // the middle vertex onto one at the side: two faces lose all
    const Mesh mesh = gate_mesh(raw, {-1.0, false}).mesh; // else it becomes the one at the side
    Index without_area = 0;
    for (const Face f : mesh.all_faces()) {
        without_area += mesh.face_areas[f] > 0.0 ? 0 : 1;
        EXPECT_LT((mesh.face_normals[f] - Vec3::UnitZ()).norm(), 1e-12);
    }
    EXPECT_EQ(without_area, 2);
}

} // namespace
} // namespace devseg::mesh
