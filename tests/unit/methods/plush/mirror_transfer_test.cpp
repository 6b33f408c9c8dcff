#include "devseg/methods/plush/transfer_seams.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "devseg/atlas/fragments.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::plush {
namespace {

// A ball whose edges do not know of the plane.
Mesh turned_ball() {
    mesh::RawMesh raw = shapes::sphere(4);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 0.5).normalized()).toRotationMatrix();
    for (Vec3& p : raw.points)
        p = turn * p;
    return checks::gated(raw);
}

MirrorPlane middle_of(const Mesh& mesh) {
    const Vec3 sum = std::accumulate(mesh.points.begin(), mesh.points.end(), Vec3(Vec3::Zero()));
    return {Vec3::UnitX(), sum.x() / static_cast<double>(mesh.points.size()), 0.0};
}

// Around caps on both sides, and along the plane: four patches.
SeamMarks caps(const WorkingSurface& surface) {
    const Mesh& mesh = surface.mesh;
    const double cap = 0.5 * std::sqrt(mesh.total_area / (4.0 * shapes::pi));
    std::vector<Index> label; // without teeth, which a transfer takes away
    for (const Face f : mesh.all_faces())
        label.push_back(std::abs(surface.side.height(mesh.face_centers[f])) > cap ? 1 : 0);
    atlas::remove_teeth(mesh, label);
    SeamMarks seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (surface.is_on_plane(h) || label[face_of(h)] != label[face_of(mesh.twin[h])])
            mark(mesh, h, 1, seam);
    mirror_marks(surface, seam);
    return seam;
}

bool are_neighbours(const Mesh& mesh, Index a, Index b) {
    return std::any_of(mesh.faces.begin(), mesh.faces.end(), [&](const Triangle& t) {
        return std::count(t.begin(), t.end(), a) + std::count(t.begin(), t.end(), b) == 2;
    });
}

TEST(MirroredModel, OwnHalfKeepsItsVertices) {
    const Mesh mesh = turned_ball();
    const auto model = mirrored_model(mesh, middle_of(mesh));
    ASSERT_TRUE(model.has_value());
    const Mesh& half = model->surface.mesh;
    EXPECT_NEAR(half.total_area, mesh.total_area, 0.01 * mesh.total_area);
    Index kept = 0;
    Index pairs = 0;
    for (const HalfEdge h : half.all_half_edges()) {
        if (model->surface.is_image(h))
            continue;
        const Index a = model->place[half.origin(h)];
        const Index b = model->place[half.target(h)];
        ASSERT_GE(a, 0);
        ASSERT_GE(b, 0);
        kept += half.points[half.origin(h)] == mesh.points[a] ? 1 : 0;
        if (++pairs % 20 == 0) {
            EXPECT_TRUE(a == b || are_neighbours(mesh, a, b));
        }
    }
    EXPECT_GT(kept, 0.9 * pairs);
}

TEST(MirrorTransfer, OneHalfOfTheModelGetsItsSeamsEdgeByEdge) {
    const Mesh mesh = turned_ball();
    const auto mirrored = mirrored_model(mesh, middle_of(mesh));
    ASSERT_TRUE(mirrored.has_value());
    const Mesh& half = mirrored->surface.mesh;
    const SeamMarks seam = caps(mirrored->surface);
    const VertexGraph graph = build_vertex_graph(mesh);
    Progress progress;
    const SeamMarks marks = seams_on_model(*mirrored, half, seam, mesh, graph, progress);
    std::vector<double> areas;
    for (const std::vector<Index>& patch : patches_of(mesh, marks)) {
        areas.push_back(0.0);
        for (const Face f : patch)
            areas.back() += mesh.face_areas[f] / mesh.total_area;
    }
    std::sort(areas.begin(), areas.end());
    ASSERT_EQ(areas.size(), 4U);
    EXPECT_NEAR(areas[0], areas[1], 0.01);
    EXPECT_NEAR(areas[2], areas[3], 0.01);
    EXPECT_NEAR(areas[0] + areas[3], 0.5, 0.02);
    Index same = 0;
    for (const HalfEdge h : half.all_half_edges()) {
        if (seam[h] == 0 || mirrored->surface.is_image(h) || mirrored->surface.is_on_plane(h))
            continue;
        ++same;
        bool found = false;
        for (const HalfEdge e : mesh.all_half_edges())
            found = found ||
                    (marks[e] != 0 && mesh.points[mesh.origin(e)] == half.points[half.origin(h)] &&
                     mesh.points[mesh.target(e)] == half.points[half.target(h)]);
        EXPECT_TRUE(found);
    }
    EXPECT_GT(same, 20);
}

} // namespace
} // namespace devseg::plush
