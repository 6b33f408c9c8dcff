// Nets of polyhedra: few, exact, and no flat face is cut.
#include <set>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/flatten/flatten.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/papercraft/nets.h"
#include "devseg/methods/papercraft/papercraft.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::papercraft {
namespace {

atlas::ChartMap nets_of(const Mesh& mesh) {
    return unfold_into_nets(mesh, {}, Progress());
}

Index cut_edges(const Mesh& mesh, const atlas::ChartMap& charts) {
    Index edges = 0;
    for (const HalfEdge h : mesh.all_half_edges())
        edges += mesh.twin[h] > h && charts.seam[h] != 0 ? 1 : 0;
    return edges;
}

// The map that a net gets is that of the paper, in one piece.
void expect_exact(const Mesh& mesh, const atlas::ChartMap& charts) {
    EXPECT_TRUE(checks::is_valid(mesh, charts));
    Progress progress;
    const flatten::FlattenResult flat = flatten::flatten_charts(
        mesh, charts, flatten::FlattenMethod::symmetric_dirichlet, progress);
    EXPECT_EQ(flat.charts.count, charts.count);
    for (const flatten::FlatChart& chart : flat.flat) {
        EXPECT_TRUE(chart.developed);
        for (const HalfEdge h : chart.surface.all_half_edges())
            EXPECT_NEAR(
                (chart.uv[chart.surface.target(h)] - chart.uv[chart.surface.origin(h)]).norm(),
                mesh.edge_length(chart.surface.mesh_half_edge(h)), 1e-9);
    }
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && regions.label[face_of(h)] == regions.label[mesh.across(h)]) {
            EXPECT_EQ(charts.seam[h], 0);
        }
}

TEST(Nets, ConvexPolyhedraAreOnePiece) {
    for (const mesh::RawMesh& raw :
         {shapes::cube(1), shapes::cube(3), shapes::tetrahedron(), shapes::sphere(1),
          shapes::capped_cylinder(12, 1), shapes::frustum(9, 1, 1.0, 0.4, 1.5)}) {
        const Mesh mesh = checks::gated(raw);
        const atlas::ChartMap charts = nets_of(mesh);
        EXPECT_EQ(charts.count, 1);
        expect_exact(mesh, charts);
    }
}

TEST(Nets, ACubeIsCutAlongSevenEdges) {
    const Mesh mesh = checks::gated(shapes::cube(1));
    EXPECT_EQ(cut_edges(mesh, nets_of(mesh)), 7);
}

TEST(Nets, PrismsWithInnerCornersAndHandlesAreFewPieces) {
    for (const shapes::Mask& mask :
         {shapes::Mask{"##", "#."}, shapes::Mask{"###", "#.#"}, shapes::mask_with_holes(1)}) {
        const Mesh mesh = checks::gated(shapes::slab(mask));
        const atlas::ChartMap charts = nets_of(mesh);
        EXPECT_LE(charts.count, 2);
        expect_exact(mesh, charts);
    }
}

TEST(Nets, WhatUnfoldsAlreadyIsNotCut) {
    for (const mesh::RawMesh& raw :
         {shapes::folded_strip(8, 6, 0.7), shapes::plate(shapes::mask_with_holes(2))}) {
        const Mesh mesh = checks::gated(raw);
        const atlas::ChartMap charts = nets_of(mesh);
        EXPECT_EQ(charts.count, 1);
        EXPECT_EQ(cut_edges(mesh, charts), 0);
    }
}

TEST(Nets, StripsThatWouldLieOnThemselvesArePieces) {
    const Mesh mesh = checks::gated(shapes::helix_strip(40, 1.6, 1.0, 2.0, 0.2));
    const atlas::ChartMap charts = nets_of(mesh);
    EXPECT_GE(charts.count, 2);
    EXPECT_LE(charts.count, 3);
    expect_exact(mesh, charts);
}

TEST(Nets, HaveNoMoreFacesThanTheyMay) {
    const Mesh mesh = checks::gated(shapes::cube(2));
    for (const int most : {1, 2, 3, 6}) {
        const atlas::ChartMap charts = unfold_into_nets(mesh, {0, most}, Progress());
        EXPECT_GE(charts.count, 6 / most);
        expect_exact(mesh, charts);
        const mesh::FaceComponents regions = mesh::flat_regions(mesh);
        for (Index c = 0; c < charts.count; ++c) {
            std::set<Index> faces;
            for (const Face f : mesh.all_faces())
                if (charts.chart[f] == c)
                    faces.insert(regions.label[f]);
            EXPECT_LE(static_cast<int>(faces.size()), most);
        }
    }
}

TEST(Nets, AreForComponentsOfFewFaces) {
    const Mesh mesh = checks::gated(
        shapes::join(shapes::sphere(3), shapes::moved(shapes::cube(4), 1.0, Vec3(3, 0, 0))));
    PapercraftOptions options;
    options.charts_number = 5;
    Progress progress;
    const PapercraftResult both = segment_papercraft(mesh, options, progress);
    EXPECT_EQ(both.nets, 1);
    EXPECT_EQ(both.charts.count, 6);
    EXPECT_TRUE(checks::is_valid(mesh, both.charts));
    options.deform = Deform::always;
    EXPECT_EQ(segment_papercraft(mesh, options, progress).nets, 0);
    options.deform = Deform::never;
    const PapercraftResult nets = segment_papercraft(mesh, options, progress);
    EXPECT_EQ(nets.nets, nets.charts.count);
    expect_exact(mesh, nets.charts);
}

TEST(Nets, AreTheSameEveryTimeAndOthersWithAnotherSeed) {
    const Mesh mesh = checks::gated(shapes::sphere(2));
    const atlas::ChartMap charts = nets_of(mesh);
    EXPECT_EQ(charts.seam, nets_of(mesh).seam);
    EXPECT_NE(charts.seam, unfold_into_nets(mesh, {1, 0}, Progress()).seam);
}

TEST(Nets, CanBeCancelled) {
    const Mesh mesh = checks::gated(shapes::sphere(3));
    PapercraftOptions options;
    options.deform = Deform::never;
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW(segment_papercraft(mesh, options, progress), Cancelled);
}

} // namespace
} // namespace devseg::papercraft
