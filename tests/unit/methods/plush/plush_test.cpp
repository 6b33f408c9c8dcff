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
#include "devseg/methods/plush/seam_smoothing.h"
#include "devseg/methods/plush/surface_fields.h"
#include "devseg/methods/plush/transfer_seams.h"
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

// Of 99 % of the area, and twice that anywhere, by another way than the method's own measure: lines
// in many directions on each face.
void expect_strain_within(const flatten::FlatteningProblem& problem, const std::vector<Vec2>& uv,
                          double bound) {
    double above = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Triangle& t = problem.faces[f];
        Eigen::Matrix2d flat;
        flat << uv[t[1]] - uv[t[0]], uv[t[2]] - uv[t[0]];
        const Eigen::Matrix2d to_surface = problem.edges[f] * flat.inverse();
        double strain = 0.0;
        for (int i = 0; i < 90; ++i) {
            const double angle = shapes::pi * i / 90.0;
            const Vec2 line = to_surface * Vec2(std::cos(angle), std::sin(angle));
            strain = std::max(strain, std::abs(line.norm() - 1.0));
        }
        EXPECT_LE(strain, 2.0 * bound);
        above += strain > bound ? problem.area[f] : 0.0;
    }
    EXPECT_LE(above, 0.01 * problem.total_area);
}

void expect_promises(const Mesh& mesh, const PlushOptions& options, const PlushSeams& seams) {
    EXPECT_TRUE(checks::is_valid(mesh, seams.charts));
    for (Index c = 0; c < seams.charts.count; ++c) {
        EXPECT_TRUE(checks::is_sound(mesh, seams.charts, c));
    }
    EXPECT_TRUE(seams.all_developable);
    // 'Charts: Flatten' makes the maps that were accepted.
    Progress progress;
    const flatten::FlattenResult flat =
        flatten::flatten_charts(mesh, seams.charts,
                                options.max_strain > 0.0 ? flatten::FlattenMethod::lpfb
                                                         : flatten::FlattenMethod::lpfb_even_areas,
                                progress);
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
        if (options.max_strain > 0.0)
            expect_strain_within(problem, chart.uv, options.max_strain);
        for (const double r : options.max_strain > 0.0 ? std::vector<double>() : ratio) {
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
        EXPECT_LE(seams.strain.most_of_it, options.max_strain);
        EXPECT_LE(seams.strain.worst, 2.0 * options.max_strain);
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
    const BoneWeights weights = bone_weights(ball, make_laplacian(ball), skeleton, Progress());
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
    EXPECT_GE(mirrored_share(mesh, seams.charts.seam), 0.92);
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
    const SeamMarks moved =
        transfer_seams(coarse, seam, fine, build_vertex_graph(fine),
                       std::vector<double>(fine.twin.size(), 1.0), {}, progress);
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
    options.max_strain = 0.4;
    const PlushSeams loose = segment(mesh, options);
    options.max_strain = 0.08;
    const PlushSeams tight = segment(mesh, options);
    expect_promises(mesh, options, tight);
    EXPECT_GT(tight.charts.count + tight.darts, loose.charts.count + loose.darts);
}

TEST(PlushSeams, WithoutStrainAreasCount) {
    const Mesh mesh = checks::gated(doll());
    PlushOptions options;
    options.max_strain = 0.0;
    options.max_area_change = 0.3;
    const PlushSeams loose = segment(mesh, options);
    options.max_area_change = 0.06;
    const PlushSeams tight = segment(mesh, options);
    expect_promises(mesh, options, tight);
    EXPECT_LE(tight.max_area_change, options.max_area_change);
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

} // namespace
} // namespace devseg::plush
