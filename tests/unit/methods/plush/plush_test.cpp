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
#include "devseg/methods/plush/patch_trial.h"
#include "devseg/methods/plush/seam_smoothing.h"
#include "devseg/methods/plush/transfer_seams.h"
#include "devseg/methods/plush/surface_fields.h"
#include "devseg/methods/plush/working_surface.h"
#include "unit/checks.h"
#include "unit/shapes.h"
#include "unit/temporary_folder.h"

namespace devseg::plush {
namespace {

// Two balls on one axis with a waist between them, like a doll without arms.
mesh::RawMesh doll(Index around = 32) {
    std::vector<Vec2> profile;
    for (int i = 0; i <= 40; ++i) {
        const double t = shapes::pi * i / 40.0;
        const double z = -2.0 * std::cos(t);
        profile.emplace_back(i == 0 || i == 40 ? 0.0 : std::sin(t) * (0.6 + 0.4 * z * z / 2.0), z);
    }
    return shapes::revolve(profile, around);
}

PlushSeams segment(const Mesh& mesh, const PlushOptions& options,
                   const std::vector<std::uint8_t>& hard = {}) {
    Progress progress;
    return segment_plush_seams(mesh, options, {}, hard, progress);
}

void expect_promises(const Mesh& mesh, const PlushOptions& options, const PlushSeams& seams) {
    EXPECT_TRUE(checks::is_valid(mesh, seams.charts));
    for (Index c = 0; c < seams.charts.count; ++c) {
        const checks::Topology topology = checks::topology(mesh, seams.charts, c);
        EXPECT_EQ(topology.euler, 1);
        EXPECT_EQ(topology.loops, 1);
    }
    EXPECT_TRUE(seams.all_developable);
    // 'Charts: Flatten' makes the maps that were accepted.
    Progress progress;
    const flatten::FlattenResult flat =
        flatten::flatten_charts(mesh, seams.charts, flatten::FlattenMethod::lpfb, progress);
    EXPECT_EQ(flat.cuts, 0);
    EXPECT_EQ(flat.charts.count, seams.charts.count);
    for (const flatten::FlatChart& chart : flat.flat) {
        const flatten::FlatteningProblem problem =
            flatten::make_flattening_problem(mesh, chart.surface);
        EXPECT_EQ(checks::count_flips(problem.faces, chart.uv), 0);
        double plane = 0.0;
        std::vector<double> ratio;
        for (std::size_t f = 0; f < problem.faces.size(); ++f) {
            const Triangle& t = problem.faces[f];
            const Vec2 p = chart.uv[t[1]] - chart.uv[t[0]];
            const Vec2 q = chart.uv[t[2]] - chart.uv[t[0]];
            ratio.push_back(0.5 * (p.x() * q.y() - p.y() * q.x()) / problem.area[f]);
            plane += ratio.back() * problem.area[f];
        }
        for (const double r : ratio) {
            EXPECT_NEAR(r, 1.0, options.max_area_change);
            EXPECT_NEAR(r * problem.total_area / plane, 1.0, options.max_area_change);
        }
        // Seams keep their length.
        for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
            const std::size_t n = (i + 1) % problem.boundary.size();
            const double length =
                (chart.uv[problem.boundary[n]] - chart.uv[problem.boundary[i]]).norm();
            EXPECT_NEAR(length, problem.boundary_edge[i], 2e-3 * problem.boundary_edge[i] + 2e-4);
        }
    }
}

TEST(PlushSeams, PatchesOfBallAndDollLieFlat) {
    for (const mesh::RawMesh& raw : {shapes::sphere(3), doll()}) {
        const Mesh mesh = checks::gated(raw);
        const PlushOptions options;
        const PlushSeams seams = segment(mesh, options);
        expect_promises(mesh, options, seams);
        EXPECT_LE(seams.charts.count, 12);
        EXPECT_GE(seams.charts.count + seams.darts, 2);
        EXPECT_LT(seams.charts.count, seams.candidates);
        EXPECT_LE(seams.max_area_change, options.max_area_change);
    }
}

// A body with two arms and two legs, the same on both sides of the plane x = 0 only; the mesh is
// not symmetric.
mesh::RawMesh animal() {
    mesh::RawMesh raw = shapes::sphere(4);
    const std::vector<std::pair<Vec3, double>> limbs = {
        {{0.8, 0.5, 0.33}, 1.1}, {{0.6, -0.75, 0.2}, 0.9}, {{0.0, 0.9, -0.43}, 0.5}};
    for (Vec3& p : raw.points) {
        const Vec3 folded(std::abs(p.x()), p.y(), p.z());
        double radius = 1.0;
        for (const auto& [direction, length] : limbs)
            radius += length * std::exp(14.0 * (folded.dot(direction.normalized()) - 1.0));
        p = radius * p.cwiseProduct(Vec3(1.0, 1.4, 0.9));
    }
    return raw;
}

TEST(SeamGuides, TellWhatLooksNatural) {
    // A tube around a bone: cuts along it look natural, rings around it do not.
    const Mesh tube = checks::gated(shapes::cylinder_tube(48, 24));
    Skeleton skeleton;
    skeleton.joints = {Vec3(0.0, 0.0, -1.0), Vec3(0.0, 0.0, 1.0)};
    skeleton.bones = {{0, 1}};
    SeamMarks along(tube.twin.size(), 0);
    SeamMarks around(tube.twin.size(), 0);
    for (const HalfEdge h : tube.all_half_edges()) {
        const Vec3 edge = tube.points[tube.target(h)] - tube.points[tube.origin(h)];
        if (edge.head<2>().norm() < 1e-9)
            mark(tube, h, 1, along);
        if (std::abs(edge.z()) < 1e-9)
            mark(tube, h, 1, around);
    }
    const Progress progress;
    const SeamGuides guides{skeleton, {}};
    EXPECT_DOUBLE_EQ(seam_shares(tube, along, guides, {}, progress).guided, 1.0);
    EXPECT_DOUBLE_EQ(seam_shares(tube, around, guides, {}, progress).guided, 0.0);
    const MirrorPlane middle{Vec3::UnitZ(), 0.0, 0.0};
    const MirrorPlane beside{Vec3::UnitX(), 5.0, 0.0};
    EXPECT_DOUBLE_EQ(seam_shares(tube, around, guides, middle, progress).mirrored, 1.0);
    EXPECT_DOUBLE_EQ(seam_shares(tube, around, guides, beside, progress).mirrored, 0.0);
    // Where a limb ends, a ring around it does.
    SeamMarks ring(tube.twin.size(), 0);
    SeamGuides border{skeleton, {}};
    const double end = tube.points[0].z();
    for (const HalfEdge h : tube.all_half_edges()) {
        const Vec3& a = tube.points[tube.origin(h)];
        const Vec3& b = tube.points[tube.target(h)];
        if (around[h] != 0 && std::abs(a.z()) < 0.5 * std::abs(end) && a.z() == b.z())
            mark(tube, h, 1, ring);
        if (ring[h] != 0)
            border.limb_borders.push_back({a, b});
    }
    EXPECT_DOUBLE_EQ(seam_shares(tube, ring, guides, {}, progress).guided, 0.0);
    EXPECT_DOUBLE_EQ(seam_shares(tube, ring, border, {}, progress).guided, 1.0);
    EXPECT_DOUBLE_EQ(seam_shares(tube, along, {{}, border.limb_borders}, {}, progress).guided, 0.0);
    // The edges of a box are creases, from outside; from inside they are grooves.
    const Mesh box = checks::gated(shapes::cube(8));
    const std::vector<EdgeShape> shape = edge_shapes(box, progress);
    for (const HalfEdge h : box.all_half_edges()) {
        const bool is_crease = box.face_normals[h / 3].dot(box.face_normals[box.twin[h] / 3]) < 0.5;
        EXPECT_NEAR(straying(1.0, shape[h].bend), is_crease ? 0.0 : 1.0, 1e-12);
        EXPECT_NEAR(straying(1.0, -shape[h].bend), is_crease ? 0.0 : 1.0, 1e-12);
    }
}

TEST(SeamGuides, FollowBonesOverTips) {
    // One bone inside a ball: lines from pole to pole follow it everywhere.
    const Mesh ball = checks::gated(shapes::sphere(4));
    Skeleton skeleton;
    skeleton.joints = {Vec3(0.0, 0.0, -0.2), Vec3(0.0, 0.0, 0.2)};
    skeleton.bones = {{0, 1}};
    const BoneWeights weights = bone_weights(ball, skeleton, Progress());
    for (const Vertex v : ball.all_vertices()) {
        const Vec3 normal = ball.points[v].normalized();
        const SkeletonDirection found = skeleton_direction(skeleton, weights, v, v, normal);
        const double away = normal.head<2>().norm(); // from the poles
        const Vec3 meridian = (Vec3::UnitZ() - normal.z() * normal).stableNormalized();
        EXPECT_NEAR(found.direction.dot(normal), 0.0, 1e-12);
        if (away > 0.05) {
            EXPECT_NEAR(std::abs(found.direction.dot(meridian)), 1.0, 1e-9);
        }
        EXPECT_NEAR(found.agreement, std::min(1.0, away * away / 0.12), 1e-9);
    }
    // Bones in all directions of the surface have none together.
    skeleton.joints.insert(skeleton.joints.end(), {Vec3(-0.2, 0.0, 0.0), Vec3(0.2, 0.0, 0.0)});
    skeleton.bones.push_back({2, 3});
    const BoneWeights even(1, {{0, 0.5}, {1, 0.5}});
    EXPECT_NEAR(skeleton_direction(skeleton, even, 0, 0, Vec3::UnitY()).agreement, 0.0, 1e-12);
}

// The share of the seam length that has its mirror image within 2 % of the diagonal.
double mirrored_share(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : mesh.points)
        box.extend(p);
    std::vector<std::pair<Vec3, double>> edges;
    for (const HalfEdge h : mesh.all_half_edges())
        if (seam[h] != 0 && mesh.twin[h] > h)
            edges.emplace_back(0.5 * (mesh.points[mesh.origin(h)] + mesh.points[mesh.target(h)]),
                               mesh.edge_length(h));
    double total = 0.0;
    double mirrored = 0.0;
    for (const auto& [middle, length] : edges) {
        const Vec3 image(2.0 * box.center().x() - middle.x(), middle.y(), middle.z());
        total += length;
        for (const auto& [other, unused] : edges)
            if ((other - image).norm() < 0.02 * box.diagonal().norm()) {
                mirrored += length;
                break;
            }
    }
    return mirrored / total;
}

TEST(PlushSeams, SeamsOfASymmetricBodyAreSymmetric) {
    const Mesh mesh = checks::gated(animal());
    PlushOptions options;
    const PlushSeams seams = segment(mesh, options);
    expect_promises(mesh, options, seams);
    EXPECT_TRUE(seams.is_symmetric);
    EXPECT_GE(mirrored_share(mesh, seams.charts.seam), 0.95);
    EXPECT_LE(seams.charts.count, 14);
    options.symmetric = false;
    const PlushSeams free = segment(mesh, options);
    EXPECT_FALSE(free.is_symmetric);
    EXPECT_LT(mirrored_share(mesh, free.charts.seam), 0.9);
}

TEST(PlushSeams, SeamsAreCarriedToAFinerSurface) {
    const Mesh coarse = checks::gated(shapes::cylinder_tube(12, 6));
    const Mesh fine = checks::gated(shapes::cylinder_tube(48, 24));
    SeamMarks seam(coarse.twin.size(), 0);
    for (const HalfEdge h : coarse.all_half_edges()) // a ring in the middle, and a cut along it
        if ((std::abs(coarse.points[coarse.origin(h)].z()) < 1e-9 &&
             std::abs(coarse.points[coarse.target(h)].z()) < 1e-9) ||
            (coarse.points[coarse.origin(h)].head<2>() - coarse.points[0].head<2>()).norm() +
                    (coarse.points[coarse.target(h)].head<2>() - coarse.points[0].head<2>())
                        .norm() <
                1e-9)
            mark(coarse, h, 1, seam);
    const mesh::FaceComponents before = find_patches(coarse, seam);
    Progress progress;
    const SeamMarks moved = transfer_seams(coarse, seam, fine, build_vertex_graph(fine),
                                           std::vector<double>(fine.twin.size(), 0.0), progress);
    EXPECT_EQ(before.count, 2);
    EXPECT_EQ(find_patches(fine, moved).count, before.count);
    const std::vector<double> even(moved.size(), 1.0);
    double length = 0.0;
    for (const SeamSegment& segment : find_segments(fine, moved, {}, even))
        length += segment.length;
    const double size = 1.0 / fine.unit_length;
    EXPECT_NEAR(length, (2.0 * shapes::pi + 2.0) * size, 0.2 * size);
}

TEST(PlushSeams, SmallerBoundsTakeMoreSeam) {
    const Mesh mesh = checks::gated(doll());
    PlushOptions options;
    options.max_area_change = 0.3;
    const PlushSeams loose = segment(mesh, options);
    options.max_area_change = 0.06;
    const PlushSeams tight = segment(mesh, options);
    expect_promises(mesh, options, tight);
    EXPECT_GT(tight.charts.count + tight.darts, loose.charts.count + loose.darts);
}

TEST(PlushSeams, DevelopableSurfaceIsOnePatch) {
    const Mesh mesh = checks::gated(shapes::cylinder_tube(24, 12));
    const PlushSeams seams = segment(mesh, PlushOptions{});
    EXPECT_EQ(seams.charts.count, 1);
    expect_promises(mesh, PlushOptions{}, seams);
}

TEST(PlushSeams, LargeModelsGetTheSeamsOfSmallerOnes) {
    const Mesh mesh = checks::gated(shapes::finger(200, 154, 0.3, 2.0));
    ASSERT_GT(mesh.face_count(), 60000);
    const PlushSeams seams = segment(mesh, PlushOptions{});
    expect_promises(mesh, PlushOptions{}, seams);
    EXPECT_LE(seams.charts.count, 4); // where its own trials cut it up there are 22
}

TEST(PlushSeams, MaterialBordersStay) {
    const Mesh mesh = checks::gated(shapes::cylinder_tube(24, 12));
    std::vector<std::uint8_t> hard(mesh.twin.size(), 0);
    Index count = 0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index twin = mesh.twin[h];
        if (twin < 0)
            continue;
        const bool above = mesh.face_centers[h / 3].z() > 0.0;
        hard[h] = above != (mesh.face_centers[twin / 3].z() > 0.0) ? 1 : 0;
        count += hard[h];
    }
    ASSERT_EQ(count, 2 * 24);
    const PlushSeams seams = segment(mesh, PlushOptions{}, hard);
    EXPECT_EQ(seams.charts.count, 2);
    for (std::size_t h = 0; h < hard.size(); ++h)
        EXPECT_GE(seams.charts.seam[h], hard[h]);
}

TEST(PlushSeams, ResultDoesNotDependOnThreads) {
    const Mesh mesh = checks::gated(doll());
    set_thread_limit(1);
    const PlushSeams one = segment(mesh, PlushOptions{});
    set_thread_limit(0);
    const PlushSeams all = segment(mesh, PlushOptions{});
    EXPECT_EQ(one.charts.seam, all.charts.seam);
    EXPECT_EQ(one.area_change, all.area_change);
}

TEST(PlushSeams, RefusesAndCancels) {
    const Mesh mesh = checks::gated(doll());
    PlushOptions options;
    options.max_area_change = 0.0;
    checks::error_of<InvalidParameter>([&] { segment(mesh, options); });
    options = {};
    options.max_extrema = -1;
    checks::error_of<InvalidParameter>([&] { segment(mesh, options); });
    for (const double when : {0.02, 0.3, 0.6}) {
        Progress progress([&](double fraction, const char*) { return fraction < when; });
        EXPECT_THROW(segment_plush_seams(mesh, PlushOptions{}, {}, {}, progress), Cancelled);
    }
}

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
    PatchTester tester(surface, {0.15, true});
    Progress progress;
    RemovalOptions options;
    options.most_together = 1.1; // no patch is large
    const Index trials =
        join_patches({surface, graph, hard, weight, tester, tester}, options, seam, progress);
    EXPECT_EQ(trials, 1); // those that were made besides do not count
    EXPECT_EQ(std::count(seam.begin(), seam.end(), 1), 0);
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
        const auto surface = mirrored_working_surface(mesh, *plane, most, Progress{});
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
    const BoneWeights weights = bone_weights(mesh, skeleton, Progress{});
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
    const auto limbs =
        find_limbs(mesh, build_vertex_graph(mesh), mean_curvature(mesh), {tip}, Progress{});
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

TEST(PatchTrial, TubesPassAndHemispheresDoNot) {
    const auto accepted = [](const mesh::RawMesh& raw) {
        const checks::Disk disk(raw);
        return try_patch(disk.mesh, disk.surface.face, disk.charts.seam, {}, false, Progress{})
            .accepted;
    };
    EXPECT_TRUE(accepted(shapes::cylinder_tube(24, 8)));
    EXPECT_TRUE(accepted(shapes::grid(6, 6)));
    EXPECT_FALSE(accepted(shapes::hemisphere(32, 12)));
}

// Equations of conformal maps are singular there; the answer is a map all the same.
TEST(PatchTrial, NeedlesAreMapped) {
    for (const double height : {1e-5, 1e-9, 1e-11, 1e-13}) {
        const checks::Disk disk({{{0, 0, 0}, {1, 0, 0}, {0, height, 0}}, {{0, 1, 2}}});
        const PatchTrial trial =
            try_patch(disk.mesh, disk.surface.face, disk.charts.seam, {}, true, Progress{});
        ASSERT_EQ(trial.change.size(), 1U);
        EXPECT_TRUE(std::isfinite(trial.change[0])) << height;
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
    const SeamSetting setting{surface, graph, {}, weight, tester, tester, 100};
    Progress progress;
    remove_seams(setting, RemovalOptions{}, seam, progress);
    EXPECT_EQ(find_patches(mesh, seam).count, 1);
    EXPECT_EQ(find_segments(mesh, seam, {}, weight).size(), 0U);
}

TEST(SeamSmoothing, TeethGo) {
    const Mesh mesh = checks::gated(shapes::grid(10, 10));
    std::vector<Index> label(mesh.faces.size());
    for (std::size_t f = 0; f < label.size(); ++f)
        label[f] = mesh.face_centers[f].x() > 0.0 ? 1 : 0;
    std::vector<Index> toothed = label;
    for (const Face f : mesh.all_faces())
        for (const HalfEdge h : half_edges_of(f))
            if (mesh.twin[h] >= 0 && label[f] == 0 && f % 4 == 0 && label[mesh.twin[h] / 3] == 1)
                toothed[f] = 1;
    EXPECT_NE(toothed, label);
    remove_teeth(mesh, toothed);
    for (const Face f : mesh.all_faces()) {
        int others = 0;
        for (const HalfEdge h : half_edges_of(f))
            others += mesh.twin[h] >= 0 && toothed[mesh.twin[h] / 3] != toothed[f];
        EXPECT_LT(others, 2);
    }
}

} // namespace
} // namespace devseg::plush
