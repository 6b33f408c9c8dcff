#include "devseg/mesh/coarsen.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::mesh {
namespace {

using shapes::Random;

CoarseSurface coarsened(const Mesh& mesh, Index target) {
    return coarsen(mesh, target, Progress{}).surface;
}

// A prism without its ends: six creases from rim to rim.
RawMesh prism() {
    RawMesh mesh = shapes::cylinder_tube(48, 20);
    for (Vec3& p : mesh.points) { // from the circle to the hexagon inside of it
        const double sector =
            std::fmod(std::atan2(p.y(), p.x()) + 4.0 * shapes::pi, shapes::pi / 3.0) -
            shapes::pi / 6.0;
        const double r = std::cos(shapes::pi / 6.0) / std::cos(sector);
        p.x() *= r;
        p.y() *= r;
    }
    return mesh;
}

std::vector<Mesh> surfaces() {
    std::vector<Mesh> meshes;
    for (const RawMesh& raw :
         {shapes::sphere(3), shapes::torus(40, 20), shapes::hemisphere(40, 20),
          shapes::grid(30, 20), shapes::annulus(60, 10, 1.0, 2.0), prism(),
          shapes::slab({"#######", "##.#.##", "#######"}), shapes::plate_with_handle(),
          shapes::with_noise(shapes::grid(20, 20), 0.02, 3), shapes::cone(30, 20)})
        meshes.push_back(checks::gated(raw));
    return meshes;
}

checks::Topology whole_topology(const Mesh& mesh) {
    return checks::topology(mesh, checks::components(mesh), 0);
}

std::vector<Index> vertices_of(const CoarseSurface& surface) {
    std::set<Index> found;
    for (std::size_t f = 0; f < surface.faces.size(); ++f)
        if (surface.alive[f] != 0)
            found.insert(surface.faces[f].begin(), surface.faces[f].end());
    return {found.begin(), found.end()};
}

TEST(Coarsen, ReachesItsTargetAndCountsWell) {
    for (const Mesh& mesh : surfaces()) {
        const Index target = mesh.face_count() / 3;
        const CoarseSurface s = coarsened(mesh, target);
        EXPECT_EQ(s.alive_faces, std::count(s.alive.begin(), s.alive.end(), 1));
        EXPECT_EQ(vertices_of(s).size() + s.collapses.size(), mesh.points.size());
        ASSERT_FALSE(s.rounds.empty());
        EXPECT_EQ(s.rounds.back(), s.collapses.size());
        EXPECT_TRUE(std::is_sorted(s.rounds.begin(), s.rounds.end()));
        if (mesh.face_count() > 1000) {
            EXPECT_LE(s.alive_faces, target);
            EXPECT_GE(s.alive_faces, target - 1);
        }
    }
}

TEST(Coarsen, SmallSurfacesStayAsTheyAre) {
    const Mesh mesh = checks::gated(shapes::sphere(1));
    const CoarseSurface s = coarsened(mesh, mesh.face_count());
    EXPECT_TRUE(s.collapses.empty());
    EXPECT_EQ(s.faces, mesh.faces);
    EXPECT_EQ(s.twin, mesh.twin);
    EXPECT_EQ(coarsened(checks::gated(shapes::tetrahedron()), 0).alive_faces, 4);
    EXPECT_EQ(coarsened(checks::gated(shapes::grid(1, 1)), 0).alive_faces, 1);
}

TEST(Coarsen, TheTopologyStaysThatOfTheSurface) {
    for (const Mesh& mesh : surfaces()) {
        const checks::Topology fine = whole_topology(mesh);
        for (const Index target : {mesh.face_count() / 2, mesh.face_count() / 8, 0}) {
            const CoarseMesh coarse = coarsen(mesh, target, Progress{});
            ASSERT_TRUE(checks::is_valid(coarse.mesh));
            const checks::Topology found = whole_topology(coarse.mesh);
            EXPECT_EQ(found.euler, fine.euler);
            EXPECT_EQ(found.loops, fine.loops);
            std::set<std::pair<Index, Index>> directed; // an edge has two faces, and so one twin
            for (const HalfEdge h : coarse.mesh.all_half_edges())
                EXPECT_TRUE(directed.emplace(coarse.mesh.origin(h), coarse.mesh.target(h)).second);
        }
    }
}

TEST(Coarsen, UndoingGivesBackTheVerySameSurface) {
    for (const Mesh& mesh : surfaces()) {
        CoarseSurface s = coarsened(mesh, 20);
        Index step = 0;
        while (!s.collapses.empty()) {
            const bool look = ++step % 29 == 0;
            const std::vector<Index> before = look ? vertices_of(s) : std::vector<Index>{};
            const Index h = undo_collapse(s);
            if (!look)
                continue;
            std::vector<Index> expected = before;
            expected.push_back(s.faces[h / 3][h % 3]);
            std::sort(expected.begin(), expected.end());
            EXPECT_EQ(vertices_of(s), expected);
            EXPECT_FALSE(std::binary_search(before.begin(), before.end(), s.faces[h / 3][h % 3]));
            EXPECT_EQ(s.alive_faces, std::count(s.alive.begin(), s.alive.end(), 1));
            EXPECT_TRUE(checks::is_valid(extract_coarse_mesh(mesh, s).mesh));
        }
        EXPECT_EQ(s.faces, mesh.faces);
        EXPECT_EQ(s.twin, mesh.twin);
        EXPECT_EQ(s.alive_faces, mesh.face_count());
        EXPECT_EQ(std::count(s.alive.begin(), s.alive.end(), 1), mesh.face_count());
    }
}

TEST(Coarsen, VerticesOfOneRoundAreNoNeighbours) {
    const Mesh mesh = checks::gated(shapes::torus(40, 20));
    CoarseSurface s = coarsened(mesh, 60);
    ASSERT_GT(s.rounds.size(), 3U);
    for (std::size_t round = s.rounds.size(); round-- > 0;) {
        const std::size_t begin = round == 0 ? 0 : s.rounds[round - 1];
        std::set<Index> removed;
        while (s.collapses.size() > begin) {
            const Index h = undo_collapse(s);
            removed.insert(s.faces[h / 3][h % 3]);
        }
        for (std::size_t f = 0; f < s.faces.size(); ++f)
            if (s.alive[f] != 0) {
                const Triangle& t = s.faces[f];
                EXPECT_LE(removed.count(t[0]) + removed.count(t[1]) + removed.count(t[2]), 1U);
            }
    }
}

// Vertices that can go do go: another attempt on what is left finds none.
TEST(Coarsen, StopsOnlyWhereNoVertexCanGo) {
    for (const Mesh& mesh : surfaces()) {
        const CoarseSurface s = coarsened(mesh, 0);
        EXPECT_LT(s.alive_faces, mesh.face_count() / 2);
        const Mesh left = extract_coarse_mesh(mesh, s).mesh;
        EXPECT_EQ(coarsened(left, 0).alive_faces, left.face_count());
    }
}

TEST(Coarsen, PlanarPartsAndStraightCreasesAreKeptExactly) {
    for (const auto& [raw, target] : {std::pair(shapes::grid(30, 20), 40),
                                      {shapes::cube(10), 100},
                                      {prism(), 100},
                                      {shapes::slab({"#######", "##.#.##", "#######"}), 100}}) {
        const Mesh mesh = checks::gated(raw);
        const CoarseSurface s = coarsened(mesh, target);
        EXPECT_LE(s.alive_faces, target);
        const Mesh coarse = extract_coarse_mesh(mesh, s).mesh;
        EXPECT_NEAR(coarse.total_area, mesh.total_area, 1e-12 * mesh.total_area);
    }
}

TEST(Coarsen, CurvedSurfacesStayNear) {
    const Mesh mesh = checks::gated(shapes::sphere(4)); // 5120 faces
    const Mesh coarse = coarsen(mesh, 500, Progress{}).mesh;
    EXPECT_NEAR(coarse.total_area, mesh.total_area, 0.03 * mesh.total_area);
    // Round triangles: none is a needle, and none has turned over.
    for (const Face f : coarse.all_faces()) {
        const Vec3 outward = coarse.face_centers[f];
        EXPECT_GT(coarse.face_normals[f].dot(outward.normalized()), 0.8);
        double squares = 0.0;
        for (const HalfEdge h : half_edges_of(f))
            squares += std::pow(coarse.edge_length(h), 2);
        EXPECT_GT(4.0 * std::sqrt(3.0) * coarse.face_areas[f] / squares, 0.05);
    }
}

TEST(Coarsen, BoundariesStayOnTheBoundary) {
    const Mesh mesh = checks::gated(shapes::annulus(60, 10, 1.0, 2.0));
    const CoarseMesh coarse = coarsen(mesh, 200, Progress{});
    for (const HalfEdge h : coarse.mesh.all_half_edges()) {
        if (coarse.mesh.twin[h] >= 0)
            continue;
        // Both ends on the same circle.
        const double r = coarse.mesh.points[coarse.mesh.origin(h)].norm();
        const double s = coarse.mesh.points[coarse.mesh.target(h)].norm();
        EXPECT_NEAR(r, s, 1e-9);
    }
}

TEST(Coarsen, FacesWithoutAreaDoNoHarm) {
    RawMesh raw = shapes::grid(20, 20);
    for (std::size_t i = 0; i < raw.points.size(); i += 7)
        raw.points[i] = raw.points[i == 0 ? 1 : i - 1];
    const Mesh mesh = mesh::gate_mesh(raw, {-1.0, false}).mesh;
    CoarseSurface s = coarsened(mesh, 100);
    EXPECT_TRUE(checks::is_valid(extract_coarse_mesh(mesh, s).mesh));
    while (!s.collapses.empty())
        undo_collapse(s);
    EXPECT_EQ(s.faces, mesh.faces);
    EXPECT_EQ(s.twin, mesh.twin);
}

// Edge-connected labels, grown from random seeds.
std::vector<Index> grown_labels(const Mesh& mesh, Index count, std::uint32_t seed) {
    Random random(seed);
    std::vector<Index> label(mesh.faces.size(), -1);
    std::vector<Index> front;
    for (Index c = 0; c < count; ++c) {
        Index f = random.below(mesh.face_count());
        while (label[f] >= 0)
            f = (f + 1) % mesh.face_count();
        label[f] = c;
        front.push_back(f);
    }
    while (!front.empty()) {
        const std::size_t i = at(random.below(static_cast<Index>(front.size())));
        const Index f = front[i];
        front.erase(front.begin() + static_cast<std::ptrdiff_t>(i));
        for (const HalfEdge h : half_edges_of(f)) {
            const Index twin = mesh.twin[h];
            if (twin >= 0 && label[twin / 3] < 0) {
                label[twin / 3] = label[f];
                front.push_back(twin / 3);
            }
        }
    }
    return label;
}

double border_length(const Mesh& mesh, const std::vector<Index>& label) {
    double sum = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h && label[h / 3] != label[mesh.twin[h] / 3])
            sum += mesh.edge_length(h);
    return sum;
}

TEST(Coarsen, RefinedLabelsAreConnectedAndCoverAll) {
    std::uint32_t seed = 1;
    for (const Mesh& mesh : surfaces()) {
        const CoarseMesh coarse = coarsen(mesh, mesh.face_count() / 6, Progress());
        const Index count = std::min<Index>(8, coarse.mesh.face_count());
        const std::vector<Index> on_coarse = grown_labels(coarse.mesh, count, seed++);
        const std::vector<Index> fine = refine_labels(mesh, coarse, on_coarse, Progress());
        for (std::size_t f = 0; f < fine.size(); ++f) {
            ASSERT_GE(fine[f], 0);
            ASSERT_LT(fine[f], count);
        }
        for (std::size_t f = 0; f < on_coarse.size(); ++f) // only faces that come back take labels
            EXPECT_EQ(fine[coarse.face[f]], on_coarse[f]);
        const atlas::ChartMap charts =
            atlas::make_chart_map(mesh, fine, {}, false); // parts become charts
        EXPECT_EQ(charts.count, count);
        EXPECT_LT(border_length(mesh, fine), 1.6 * border_length(coarse.mesh, on_coarse) + 1e-9);
    }
}

// Borders of labels are the lines.
TEST(Coarsen, LinesStayLinesBetweenTheSameRegions) {
    unsigned seed = 7;
    for (const Mesh& mesh : surfaces()) {
        const Index count = std::min<Index>(6, mesh.face_count());
        const std::vector<Index> label = grown_labels(mesh, count, seed++);
        std::vector<std::uint8_t> lines(mesh.twin.size(), 0);
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] >= 0 && label[face_of(h)] != label[mesh.across(h)])
                lines[h] = 1;
        std::vector<std::uint8_t> fixed(mesh.points.size(), 0);
        fixed[mesh.points.size() / 2] = 1;
        Progress progress;
        const CoarseMesh coarse =
            coarsen_between_lines(mesh, mesh.face_count() / 8, lines, fixed, progress);
        ASSERT_TRUE(checks::is_valid(coarse.mesh));
        EXPECT_EQ(std::count(coarse.vertex.begin(), coarse.vertex.end(),
                             static_cast<Index>(mesh.points.size() / 2)),
                  1);
        std::vector<Index> on_coarse;
        for (const Index f : coarse.face)
            on_coarse.push_back(label[at(f)]);
        // All regions are there, each in one piece.
        EXPECT_EQ(atlas::make_chart_map(coarse.mesh, on_coarse, {}, false).count, count);
        EXPECT_EQ(std::set<Index>(on_coarse.begin(), on_coarse.end()).size(), at(count));
        const std::vector<Index>& line = coarse.surface.line;
        std::map<Index, double> on_fine; // length of each line's edges
        for (const HalfEdge h : mesh.all_half_edges())
            if (lines[h] != 0)
                on_fine[line[h]] += mesh.edge_length(h);
        std::set<Index> found;
        for (const HalfEdge h : coarse.mesh.all_half_edges()) {
            const Index number = line[at(3 * coarse.face[face_of(h)] + corner_of(h))];
            const bool is_border = coarse.mesh.twin[h] >= 0 &&
                                   on_coarse[face_of(h)] != on_coarse[coarse.mesh.across(h)];
            EXPECT_EQ(number >= 0, is_border);
            if (number < 0)
                continue;
            found.insert(number);
            EXPECT_LE(2.0 * coarse.mesh.edge_length(h), on_fine[number] + 1e-9);
            EXPECT_EQ(lines[at(number)], 1);
        }
        EXPECT_EQ(found.size(), on_fine.size()); // each became just one edge
    }
}

TEST(Coarsen, RunsAreEqualAndCanBeCancelled) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::sphere(3), 0.02, 5));
    const CoarseSurface a = coarsened(mesh, 100);
    const CoarseSurface b = coarsened(mesh, 100);
    EXPECT_EQ(a.collapses, b.collapses);
    EXPECT_EQ(a.faces, b.faces);
    Progress stopped([](double, const char*) { return false; });
    EXPECT_THROW(stopped.update(0.0), Cancelled);
    EXPECT_THROW(coarsen(mesh, 100, stopped), Cancelled);
}

} // namespace
} // namespace devseg::mesh
