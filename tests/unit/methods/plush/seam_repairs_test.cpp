#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/mesh/canonical_frame.h"
#include "devseg/methods/plush/mend_patches.h"
#include "devseg/methods/plush/plush_seams.h"
#include "devseg/methods/plush/thin_tips.h"
#include "devseg/methods/plush/transfer_seams.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::plush {
namespace {

// The edges between the faces for which `inside` holds and others.
template <class Inside>
SeamMarks seam_around(const Mesh& mesh, Inside inside) {
    SeamMarks seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 &&
            inside(mesh.face_centers[h / 3]) != inside(mesh.face_centers[mesh.twin[h] / 3]))
            seam[h] = 1;
    return seam;
}

double seam_length(const Mesh& mesh, const SeamMarks& seam) {
    double length = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        length += seam[h] != 0 ? 0.5 * mesh.edge_length(h) : 0.0;
    return length;
}

mesh::RawMesh moved(mesh::RawMesh raw, double scale) {
    const Eigen::AngleAxisd turn(1.1, Vec3(0.3, -0.5, 0.8).normalized());
    for (Vec3& p : raw.points)
        p = scale * (turn * p) + Vec3(5.0, -3.0, 2.0);
    return raw;
}

Mesh framed(const Mesh& mesh) {
    const Progress progress;
    return mesh::in_frame(mesh, mesh::canonical_frame(mesh, progress), progress);
}

TEST(CanonicalFrame, MovedMeshesAreTheSameInIt) {
    mesh::RawMesh egg = shapes::sphere(3);
    for (Vec3& p : egg.points)
        p = p.cwiseProduct(Vec3(1.0, 1.3, 0.8 + 0.2 * p.y()));
    for (const mesh::RawMesh& raw :
         {egg, shapes::sphere(3), shapes::cube(4), shapes::torus(20, 10)}) {
        const Mesh mesh = checks::gated(raw);
        const Mesh other = checks::gated(moved(raw, 0.7));
        const Mesh own = framed(mesh);
        EXPECT_EQ(own.points, framed(other).points);
        EXPECT_NEAR(own.total_area, 1.0, 1e-6);
        EXPECT_NEAR(own.unit_length, mesh.unit_length * std::sqrt(mesh.total_area), 1e-9);
        EXPECT_NEAR(mesh::canonical_frame(mesh, Progress()).axes.determinant(), 1.0,
                    1e-12); // no mirror image
    }
}

TEST(CanonicalFrame, NeedlesStayAsTheyAre) {
    mesh::RawMesh raw = shapes::grid(4, 1);
    for (Vec3& p : raw.points)
        p.y() *= 1e-15;
    const Mesh mesh = checks::gated(raw);
    EXPECT_TRUE(mesh::canonical_frame(mesh, Progress()).is_identity);
    EXPECT_EQ(framed(mesh).points, mesh.points);
    Progress progress;
    EXPECT_GE(segment_plush_seams(mesh, {}, {}, {}, progress).charts.count, 1);
}

TEST(CanonicalFrame, MovedModelsHaveTheSamePlushSeams) {
    const mesh::RawMesh raw = shapes::finger(24, 30, 0.3, 2.0);
    Progress progress;
    const PlushSeams seams = segment_plush_seams(checks::gated(raw), {}, {}, {}, progress);
    Progress again;
    const PlushSeams others =
        segment_plush_seams(checks::gated(moved(raw, 2.3)), {}, {}, {}, again);
    EXPECT_EQ(seams.charts.chart, others.charts.chart);
    EXPECT_EQ(seams.charts.seam, others.charts.seam);
    EXPECT_EQ(seams.bones, others.bones);
}

TEST(SmoothSeams, TeethGoAndEndsStay) {
    const Mesh mesh = checks::gated(shapes::grid(20, 20));
    const double tooth = 0.1 / mesh.unit_length;
    const SeamMarks seam = seam_around(mesh, [&](const Vec3& c) {
        return c.x() > (std::fmod(c.y() + 10.0 * tooth, 2.0 * tooth) < tooth ? 0.0 : tooth);
    });
    const std::vector<Vec3> points = smooth_seams(mesh, seam);
    double before = 0.0;
    double after = 0.0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index a = mesh.origin(h);
        const Index b = mesh.target(h);
        if (seam[h] != 0) {
            before += 0.5 * mesh.edge_length(h);
            after += 0.5 * (points[a] - points[b]).norm();
        }
        if (mesh.twin[h] < 0) {
            EXPECT_EQ(points[a], mesh.points[a]);
        }
    }
    EXPECT_LT(after, 0.8 * before);
}

TEST(MendPatch, PatchesThatFitStay) {
    const Mesh mesh = checks::gated(shapes::grid(10, 10));
    std::vector<Index> faces;
    for (const Face f : mesh.all_faces())
        faces.push_back(f);
    const auto cuts = mend_patch(mesh, build_vertex_graph(mesh), edge_lengths(mesh), faces,
                                 SeamMarks(mesh.twin.size(), 0), {0.1, 0.1, false}, Progress());
    ASSERT_TRUE(cuts.has_value());
    EXPECT_TRUE(cuts->empty());
}

// All faces as one patch, mended: the patches afterwards keep the limits.
std::size_t mended_patches(const mesh::RawMesh& raw, const judge::ClothLimits& limits) {
    const Mesh mesh = checks::gated(raw);
    std::vector<Index> faces;
    for (const Face f : mesh.all_faces())
        faces.push_back(f);
    SeamMarks seam(mesh.twin.size(), 0);
    const Progress progress;
    EXPECT_FALSE(judge::try_cloth(mesh, faces, seam, limits, false, progress).accepted);
    const auto cuts = mend_patch(mesh, build_vertex_graph(mesh), edge_lengths(mesh), faces, seam,
                                 limits, progress);
    if (!cuts)
        return 0;
    for (const Index h : *cuts)
        mark(mesh, h, 1, seam);
    const auto patches = patches_of(mesh, seam, faces);
    for (const auto& patch : patches)
        EXPECT_TRUE(judge::try_cloth(mesh, patch, seam, limits, false, progress).accepted);
    return patches.size();
}

TEST(MendPatch, TipsGetDarts) {
    // A blunt cone: all of its curvature is at the tip.
    EXPECT_EQ(mended_patches(shapes::cone(40, 16, 1.0, 1.0), {0.1, 0.0, false}), 1U);
    EXPECT_EQ(mended_patches(shapes::cone(40, 16, 1.0, 1.0), {0.1, 0.15, false}), 1U);
}

TEST(MendPatch, SheetsAreCutApart) {
    EXPECT_EQ(mended_patches(shapes::helix_strip(90, 1.2, 1.0, 1.4, 0.3), {0.1, 0.0, false}), 2U);
}

TEST(MendPatch, BallsAreLeftToOthers) {
    EXPECT_EQ(mended_patches(shapes::hemisphere(48, 24), {0.005, 0.0, false}), 0U);
}

// A surface with what seams on it are judged by.
struct Trials {
    explicit Trials(const mesh::RawMesh& raw) : surface{checks::gated(raw), {}} {}

    const Mesh& mesh() const { return surface.mesh; }
    double unit() const { return 1.0 / mesh().unit_length; }
    SeamSetting setting() { return {surface, graph, hard, weight, tester, tester, weight, weight}; }

    WorkingSurface surface;
    VertexGraph graph = build_vertex_graph(surface.mesh);
    SeamMarks hard;
    std::vector<double> weight = std::vector<double>(surface.mesh.twin.size(), 1.0);
    PatchTester tester{surface, {0.15, 0.0, false}};
};

TEST(Tongues, GoToThePatchBesideThem) {
    // A plate in two halves; a strip of the left one reaches far into the right one.
    Trials plate(shapes::grid(40, 40));
    const Mesh& mesh = plate.mesh();
    const double unit = plate.unit();
    SeamMarks seam = seam_around(mesh, [&](const Vec3& c) {
        return c.x() < 0.0 || (c.x() < 0.3 * unit && std::abs(c.y()) < 0.0375 * unit);
    });
    const double before = seam_length(mesh, seam);
    Progress progress;
    EXPECT_GE(give_tongues_away(plate.setting(), 0.12 * unit, seam, progress), 1);
    EXPECT_EQ(find_patches(mesh, seam).count, 2);
    EXPECT_LT(seam_length(mesh, seam), before - 0.3 * unit);
    EXPECT_NEAR(seam_length(mesh, seam), unit, 0.25 * unit);
    // A wide one stays.
    seam = seam_around(mesh, [&](const Vec3& c) {
        return c.x() < 0.0 || (c.x() < 0.3 * unit && std::abs(c.y()) < 0.2 * unit);
    });
    const SeamMarks wide = seam;
    give_tongues_away(plate.setting(), 0.12 * unit, seam, progress);
    EXPECT_EQ(seam, wide);
}

std::size_t count_acute(const Mesh& mesh, const SeamMarks& seam) {
    return find_acute_corners(mesh, seam, {}, 0.1 / mesh.unit_length, 0.6).size();
}

// Between the two halves of a plate, a wedge whose tip is at the middle.
SeamMarks wedge(const Mesh& mesh) {
    const auto patch = [](const Vec3& c) {
        return c.x() > 0.0 && std::abs(c.y()) < 0.2 * c.x() + 0.006 ? 2 : c.y() < 0.0 ? 1 : 0;
    };
    return seam_around(mesh, patch);
}

TEST(AcuteCorners, JunctionsSlideUntilTheyAreBlunt) {
    Trials plate(shapes::grid(120, 120));
    SeamMarks seam = wedge(plate.mesh());
    ASSERT_EQ(find_patches(plate.mesh(), seam).count, 3);
    ASSERT_GE(count_acute(plate.mesh(), seam), 1U);
    Progress progress;
    EXPECT_GE(blunt_acute_corners(plate.setting(), seam, progress), 1);
    EXPECT_EQ(count_acute(plate.mesh(), seam), 0U);
    EXPECT_EQ(find_patches(plate.mesh(), seam).count, 3);
    EXPECT_NEAR(seam_length(plate.mesh(), seam), seam_length(plate.mesh(), wedge(plate.mesh())),
                0.2 * plate.unit());
}

TEST(AcuteCorners, BordersOfMaterialsStay) {
    Trials plate(shapes::grid(120, 120));
    SeamMarks seam = wedge(plate.mesh());
    plate.hard = seam;
    Progress progress;
    EXPECT_EQ(blunt_acute_corners(plate.setting(), seam, progress), 0);
    EXPECT_EQ(seam, plate.hard);
}

TEST(AcuteCorners, ShortDartsBesideASeamGo) {
    Trials plate(shapes::grid(120, 120));
    const Mesh& mesh = plate.mesh();
    const SeamMarks halves = seam_around(mesh, [](const Vec3& c) { return c.y() < 0.0; });
    const VertexGraph graph = build_vertex_graph(mesh);
    const auto vertex_at = [&](double x, double y) {
        const auto nearer = [&](const Vec3& a, const Vec3& b) {
            const Vec3 place = plate.unit() * Vec3(x, y, 0.0);
            return (a - place).norm() < (b - place).norm();
        };
        return static_cast<Index>(std::min_element(mesh.points.begin(), mesh.points.end(), nearer) -
                                  mesh.points.begin());
    };
    const Index root = vertex_at(0.0, 0.0);
    std::vector<std::uint8_t> may_enter;
    for (const Vec3& p : mesh.points)
        may_enter.push_back(p.y() > 1e-9 ? 1 : 0);
    may_enter[root] = 1;
    const PathTree tree = shortest_paths(graph, edge_lengths(mesh), {root}, Progress(), may_enter);
    SeamMarks seam = halves;
    for (const Index h : trace_path(mesh, tree, vertex_at(0.08, 0.02)))
        mark(mesh, h, 1, seam);
    ASSERT_GE(count_acute(mesh, seam), 1U);
    Progress progress;
    EXPECT_GE(blunt_acute_corners(plate.setting(), seam, progress), 1);
    EXPECT_EQ(seam, halves);
}

TEST(Remnants, GoToTheirNeighbourWithoutTheirDarts) {
    // The tip of a cone as an island, and darts from both sides that end on its border.
    Trials cone(shapes::cone(24, 40, 1.0, 3.0));
    const Mesh& mesh = cone.mesh();
    const Vec3 apex = *std::max_element(mesh.points.begin(), mesh.points.end(),
                                        [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
    const double size = 0.2 * cone.unit();
    SeamMarks seam = seam_around(mesh, [&](const Vec3& c) { return (c - apex).norm() < size; });
    const SeamMarks island = seam;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Vec3 a = mesh.points[mesh.origin(h)] - apex;
        const Vec3 b = mesh.points[mesh.target(h)] - apex;
        const bool is_behind = std::abs(a.y()) + std::abs(b.y()) < 1e-9 && a.x() + b.x() < 0.0;
        const bool is_dart = std::abs(a.y()) + std::abs(b.y()) < 1e-9 && a.x() + b.x() > 0.0 &&
                             std::max(a.norm(), b.norm()) < 2.5 * size &&
                             std::min(a.norm(), b.norm()) > 0.3 * size;
        if (mesh.twin[h] >= 0 &&
            (is_dart || (is_behind && std::min(a.norm(), b.norm()) > 0.9 * size)))
            mark(mesh, h, 1, seam);
    }
    ASSERT_EQ(find_patches(mesh, seam).count, 2);
    const std::vector<Index> degree = seam_degrees(mesh, seam);
    ASSERT_EQ(std::count(degree.begin(), degree.end(), 1), 2);
    const double before = seam_length(mesh, seam);
    Progress progress;
    EXPECT_GE(absorb_remnants(cone.setting(), edge_lengths(mesh), 0.02, seam, progress), 1);
    EXPECT_EQ(find_patches(mesh, seam).count, 1);
    EXPECT_LT(seam_length(mesh, seam), before);
    // What is larger stays.
    SeamMarks large = island;
    absorb_remnants(cone.setting(), edge_lengths(mesh), 1e-4, large, progress);
    EXPECT_EQ(large, island);
}

} // namespace
} // namespace devseg::plush
