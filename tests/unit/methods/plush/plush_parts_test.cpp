#include "devseg/methods/plush/plush_seams.h"
#include "devseg/methods/plush/seam_removal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include <gtest/gtest.h>

#include "devseg/base/parallel.h"
#include "devseg/flatten/flatten.h"
#include "devseg/methods/plush/limbs.h"
#include "devseg/methods/plush/patch_tester.h"
#include "devseg/methods/plush/surface_fields.h"
#include "devseg/methods/plush/transfer_seams.h"
#include "devseg/methods/plush/working_surface.h"
#include "unit/checks.h"
#include "unit/shapes.h"
#include "unit/temporary_folder.h"

namespace devseg::plush {
namespace {
TEST(SeamRemoval, OpensAsMuchOfASeamAsItCan) {
    // Two halves of a plate: all of the seam between them can go, and parts of it as well.
    const WorkingSurface surface{checks::gated(shapes::grid(20, 20, 1.0, 1.0)), {}};
    const Mesh& mesh = surface.mesh;
    double middle = 0.0;
    for (const Vec3& p : mesh.points)
        middle += p.x() / static_cast<double>(mesh.points.size());
    SeamMarks seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (std::abs(mesh.points[mesh.origin(h)].x() - middle) < 1e-9 &&
            std::abs(mesh.points[mesh.target(h)].x() - middle) < 1e-9)
            mark(mesh, h, 1, seam);
    ASSERT_EQ(find_patches(mesh, seam).count, 2);
    const VertexGraph graph = build_vertex_graph(mesh);
    const SeamMarks hard;
    const std::vector<double> weight(mesh.twin.size(), 1.0);
    PatchTester tester(surface, {});
    Progress progress;
    RemovalOptions options;
    options.most_together = 1.1; // no patch is large
    const Index trials = join_patches(
        {surface, graph, hard, weight, tester, tester, weight, weight}, options, seam, progress);
    EXPECT_EQ(trials, 1); // those that were made besides do not count
    EXPECT_EQ(std::count(seam.begin(), seam.end(), 1), 0);
}

TEST(FitSurface, LimbsFollowThoseOfTheModel) {
    mesh::RawMesh straight = shapes::sphere(3);
    for (Vec3& p : straight.points)
        p = Vec3(p.x(), 0.3 * p.y(), 0.3 * p.z());
    mesh::RawMesh bent = straight;
    for (Vec3& p : bent.points)
        p.z() += 0.15 * p.x() * p.x();
    const Mesh from = checks::gated(straight);
    const Mesh model = checks::gated(bent);
    const Mesh fitted = fitted_to(model, from, build_vertex_graph(from), Progress());
    const auto far = [&](const Mesh& mesh) { // the model's point that is farthest from the mesh
        double farthest = 0.0;
        for (const Vec3& p : model.points) {
            double nearest = infinite;
            for (const Vec3& q : mesh.points)
                nearest = std::min(nearest, (p - q).norm());
            farthest = std::max(farthest, nearest);
        }
        return farthest;
    };
    EXPECT_LT(far(fitted), 0.6 * far(from));
}

TEST(Symmetry, MirrorPlaneOfTorusOnTwoLevels) {
    mesh::RawMesh raw = shapes::torus(40, 20);
    for (Vec3& p : raw.points)
        p.x() += 0.3 * p.y() * p.y(); // bent: left and right stay, front and back differ
    const Mesh mesh = checks::gated(raw);
    Progress progress;
    const auto plane = find_mirror_plane(mesh, 0.02, progress);
    ASSERT_TRUE(plane.has_value());
    EXPECT_LT(plane->deviation, 1e-3);
    EXPECT_LT(std::abs(plane->normal.x()), 1e-3);
    for (const Index most : {20000, 600}) {
        const auto surface = mirrored_working_surface(mesh, *plane, most, most, Progress{});
        ASSERT_TRUE(surface.has_value());
        const Mesh& half = surface->mesh;
        EXPECT_LE(half.face_count(), std::max<Index>(600, 2 * mesh.face_count()));
        EXPECT_NEAR(half.total_area, mesh.total_area, 0.05 * mesh.total_area);
        Index on_plane = 0;
        for (const HalfEdge h : half.all_half_edges()) {
            const Index image = surface->image[h];
            EXPECT_EQ(surface->image[image], h);
            EXPECT_LT(
                (plane->reflect(half.points[half.origin(h)]) - half.points[half.target(image)])
                    .norm(),
                1e-9);
            ASSERT_GE(half.twin[h], 0); // the torus stays closed
            EXPECT_EQ(surface->image[half.twin[h]], half.twin[image]);
            on_plane += surface->is_on_plane(h) ? 1 : 0;
        }
        EXPECT_GT(on_plane, 0);
    }
}

TEST(Symmetry, NoPlaneWhereThereIsNone) {
    mesh::RawMesh raw = shapes::sphere(3);
    for (Vec3& p : raw.points)
        p += 0.5 * Vec3(std::sin(2.0 * p.y() + p.z()), std::sin(3.0 * p.z() + 1.0), p.x() * p.y());
    Progress progress;
    EXPECT_FALSE(find_mirror_plane(checks::gated(raw), 0.01, progress).has_value());
}

TEST(Skeleton, BonesOfCapsuleLieAlongItsAxis) {
    const Mesh mesh = checks::gated(shapes::capped_cylinder(24, 60, 0.3, 4.0));
    const Skeleton skeleton = extract_skeleton(mesh, Progress{});
    ASSERT_FALSE(skeleton.empty());
    for (const auto& [a, b] : skeleton.bones) {
        const Vec3 bone = skeleton.joints[b] - skeleton.joints[a];
        EXPECT_GT(std::abs(bone.normalized().z()), 0.95);
    }
    const BoneWeights weights = bone_weights(mesh, make_laplacian(mesh), skeleton, Progress{});
    for (const auto& row : weights) {
        double sum = 0.0;
        for (const auto& entry : row)
            sum += entry.second;
        EXPECT_NEAR(sum, 1.0, 1e-9);
    }
    EXPECT_TRUE(extract_skeleton(checks::gated(shapes::cylinder_tube(12, 6)), Progress{}).empty());
}

TEST(Skeleton, FilesAreReadOrRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("bones.obj");
    const auto write = [&](const char* text) { std::ofstream(path) << text; };
    const auto read = [&] {
        return read_skeleton(path, [](const Vec3& p) { return Vec3(0.5 * p); });
    };
    write("# bones\nv 0 0 0\nv 0 0 2\nv 0 1 2\nl 1 2 3\n");
    const Skeleton skeleton = read();
    EXPECT_EQ(skeleton.bones.size(), 2U);
    EXPECT_EQ(skeleton.joints[1], Vec3(0.0, 0.0, 1.0));
    write("v 0 0 0\nl 1 2\n");
    EXPECT_TRUE(checks::contains(checks::error_of<InvalidParameter>(read), "line 2"));
    write("v 0 0\n");
    EXPECT_TRUE(checks::contains(checks::error_of<InvalidParameter>(read), "line 1"));
    write("v 0 0 0\n");
    EXPECT_TRUE(checks::contains(checks::error_of<InvalidParameter>(read), "bone"));
    std::remove(path.c_str());
    EXPECT_TRUE(checks::contains(checks::error_of<FileError>(read), "cannot be read"));
}

TEST(Limbs, FingerOnBallHasItsSeamAtTheRoot) {
    std::vector<Vec2> profile{{0.0, 3.0}};
    for (int i = 0; i <= 20; ++i)
        profile.emplace_back(0.25, 2.95 - 0.1 * i); // the finger, down to the ball
    for (int i = 1; i < 30; ++i) {
        const double t = 0.25 + (shapes::pi - 0.25) * i / 30.0;
        profile.emplace_back(std::sin(t), std::cos(t));
    }
    profile.emplace_back(0.0, -1.0);
    std::reverse(profile.begin(), profile.end());
    const mesh::RawMesh raw = shapes::revolve(profile, 32);
    const Mesh mesh = checks::gated(raw);
    Index tip = 0;
    for (const Vertex v : mesh.all_vertices())
        if (mesh.points[v].z() > mesh.points[tip].z())
            tip = v;
    const auto limbs = find_limbs(mesh, build_vertex_graph(mesh),
                                  mean_curvature(mesh, make_laplacian(mesh)), {tip}, Progress{});
    ASSERT_EQ(limbs.size(), 1U);
    SeamMarks seam(mesh.twin.size(), 0);
    for (const Limb& limb : limbs)
        for (const Index h : limb_border(mesh, limb))
            mark(mesh, h, 1, seam);
    for (const HalfEdge h : mesh.all_half_edges())
        if (seam[h] != 0) {
            const double z = mesh.points[mesh.origin(h)].z() * mesh.unit_length + 1.0;
            EXPECT_NEAR(z, 0.95, 0.25); // in the model, where the finger meets the ball
        }
}

TEST(SeamNetwork, CrossOnPlateHasFourSegments) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    SeamMarks seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Vec3& a = mesh.points[mesh.origin(h)];
        const Vec3& b = mesh.points[mesh.target(h)];
        if ((std::abs(a.x()) < 1e-9 && std::abs(b.x()) < 1e-9) ||
            (std::abs(a.y()) < 1e-9 && std::abs(b.y()) < 1e-9))
            mark(mesh, h, 1, seam);
    }
    const std::vector<double> weight(mesh.twin.size(), 1.0);
    const auto segments = find_segments(mesh, seam, {}, weight);
    EXPECT_EQ(segments.size(), 4U);
    for (const SeamSegment& segment : segments)
        EXPECT_EQ(segment.half_edges.size(), 4U);
    EXPECT_EQ(find_patches(mesh, seam).count, 4);
    // Flat patches need no seam at all.
    const WorkingSurface surface{mesh, {}};
    PatchTester tester(surface, {});
    const VertexGraph graph = build_vertex_graph(mesh);
    const SeamMarks hard;
    const SeamSetting setting{surface, graph, hard, weight, tester, tester, weight, weight, 100};
    Progress progress;
    remove_seams(setting, RemovalOptions{}, seam, progress);
    EXPECT_EQ(find_patches(mesh, seam).count, 1);
    EXPECT_EQ(find_segments(mesh, seam, {}, weight).size(), 0U);
}

} // namespace
} // namespace devseg::plush
