// The segmentation for papercraft: growth by vertices, chart selection, slits.
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/atlas/flat_cuts.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/develop/deform.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/methods/growth/vertex_growth.h"
#include "devseg/methods/papercraft/papercraft.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::papercraft {
namespace {

Mesh lumpy_sphere() {
    return checks::gated(shapes::with_noise(shapes::sphere(3), 0.02, 5));
}

PapercraftResult segment(const Mesh& mesh, int charts, double slit_threshold = 0.1) {
    PapercraftOptions options;
    options.charts_number = charts;
    options.deform = Deform::always;
    options.slit_threshold = slit_threshold;
    Progress progress;
    return segment_papercraft(mesh, options, progress);
}

void expect_disks(const Mesh& mesh, const atlas::ChartMap& charts) {
    EXPECT_TRUE(checks::is_valid(mesh, charts));
    for (Index c = 0; c < charts.count; ++c) {
        EXPECT_TRUE(checks::is_sound(mesh, charts, c));
    }
}

TEST(Papercraft, ChartsAreAsManyAsWantedAndDisks) {
    for (const mesh::RawMesh& raw :
         {shapes::with_noise(shapes::sphere(3), 0.02, 5), shapes::double_torus(),
          shapes::with_noise(shapes::torus(40, 20), 0.03, 1), shapes::hemisphere(24, 8),
          shapes::plate_with_handle()}) {
        const Mesh mesh = checks::gated(raw);
        for (const int number : {2, 5, 12}) {
            const PapercraftResult r = segment(mesh, number);
            const std::vector<std::uint8_t> rims = atlas::rims_of_flat_faces(mesh);
            const Index least =
                mesh::face_components(mesh, [&](HalfEdge h) { return rims[h] == 0; }).count;
            EXPECT_LE(r.charts.count, std::max(number, least));
            EXPECT_GE(r.charts.count, std::min(number, r.initial_charts));
            expect_disks(mesh, r.charts);
        }
    }
}

TEST(Papercraft, FlatFacesAreNeverCut) {
    for (const mesh::RawMesh& raw :
         {shapes::slab(shapes::mask_with_holes(3)), shapes::double_torus(), shapes::cube(6),
          shapes::capped_cylinder(40, 10), shapes::plate_with_handle()}) {
        const Mesh mesh = checks::gated(raw);
        const std::vector<std::uint8_t> within = atlas::within_flat_faces(mesh);
        ASSERT_GT(std::count(within.begin(), within.end(), 1), 0);
        for (const int number : {1, 5, 12}) {
            const PapercraftResult r = segment(mesh, number);
            expect_disks(mesh, r.charts);
            for (const HalfEdge h : mesh.all_half_edges())
                EXPECT_FALSE(within[h] != 0 && r.charts.seam[h] != 0);
        }
    }
}

TEST(Papercraft, WhatStandsInAHoleOfAFlatFaceIsAComponent) {
    const Mesh mesh = checks::gated(shapes::slab(shapes::mask_with_holes(3)));
    EXPECT_EQ(segment(mesh, 1).charts.count, 4); // the rest is one
}

TEST(Papercraft, EveryComponentHasAChart) {
    mesh::RawMesh raw = shapes::sphere(2);
    for (int i = 1; i < 5; ++i)
        raw = shapes::join(raw, shapes::moved(shapes::tetrahedron(), 0.3, Vec3(3.0 * i, 0, 0)));
    raw = shapes::join(raw, shapes::moved(shapes::grid(1, 1), 1.0, Vec3(0, 5, 0)));
    const Mesh mesh = checks::gated(raw);
    const PapercraftResult r = segment(mesh, 1);
    EXPECT_EQ(r.charts.count, 6);
    expect_disks(mesh, r.charts);
}

TEST(Papercraft, ADevelopableSurfaceIsOneChartWithoutSlits) {
    for (const mesh::RawMesh& raw : {shapes::folded_strip(8, 6, 0.7), shapes::grid(9, 7)}) {
        const Mesh mesh = checks::gated(raw);
        const PapercraftResult r = segment(mesh, 1);
        EXPECT_EQ(r.charts.count, 1);
        EXPECT_EQ(r.slit_length, 0.0);
    }
}

TEST(Papercraft, CornersNeverComeInside) {
    const Mesh mesh = checks::gated(shapes::cube(6));
    const std::vector<double> defect = mesh::angle_defects(mesh);
    for (const int number : {1, 3}) {
        const PapercraftResult r = segment(mesh, number, 1000.0);
        for (const Index v : develop::inner_vertices(mesh, r.charts.seam))
            EXPECT_NEAR(defect[v], 0.0, 1e-9);
    }
}

TEST(Papercraft, FacesShareTheDefectsOfTheirVertices) {
    const Mesh mesh = lumpy_sphere();
    double all = 0.0;
    for (const double d : mesh::angle_defects(mesh))
        all += std::abs(d);
    double shared = 0.0;
    for (const double d : segment(mesh, 4).defect_share)
        shared += d;
    EXPECT_NEAR(shared, all, 1e-9);
}

TEST(Papercraft, RoundsAreBounded) {
    const Mesh mesh = lumpy_sphere();
    PapercraftOptions options;
    options.charts_number = 2;
    options.growth_threshold = 0.1;
    options.max_iterations = 2;
    Progress progress;
    const PapercraftResult r = segment_papercraft(mesh, options, progress);
    EXPECT_EQ(r.rounds, 2);
    EXPECT_EQ(r.charts.count, 2);
    EXPECT_GT(r.initial_charts, 10);
}

TEST(VertexGrowth, AChartTakesTheCheapestVertexOfItsBorder) {
    // Two columns of cheap vertices; those between them cost, and the rest far more.
    const Mesh mesh = checks::gated(shapes::grid(8, 8, 8.0, 8.0));
    std::vector<double> cost(mesh.points.size(), 5.0);
    Index seed = -1;
    for (std::size_t v = 0; v < cost.size(); ++v) {
        const Vec3 p = mesh.points[v] * mesh.unit_length; // centred
        if (std::abs(p.x()) < 0.1 && std::abs(p.y()) < 3.1)
            cost[v] = 0.0;
        if (p.norm() < 0.1)
            seed = static_cast<Index>(v);
    }
    ASSERT_GE(seed, 0);
    growth::VertexGrowth growth(mesh, cost);
    Progress progress;
    const std::vector<Index> seeds = growth.find_seeds(1.0, progress);
    // The first chart is the cheap column, and no more.
    EXPECT_EQ(cost[seeds.front()], 0.0);
    const growth::VertexCharts grown = growth.grow({seed}, progress);
    for (std::size_t v = 0; v < cost.size(); ++v)
        if (cost[v] == 0.0) {
            EXPECT_EQ(grown.inside[v], 0);
        }
}

// A slit along the middle row of a grid, from the left border to the column `end`.
struct Slit {
    explicit Slit(int end) : mesh(checks::gated(shapes::grid(8, 2, 8.0, 2.0))) {
        seam.assign(mesh.twin.size(), 0);
        cost.assign(mesh.points.size(), 0.0);
        for (const HalfEdge h : mesh.all_half_edges()) {
            const Vec3 a = at_column(mesh.origin(h));
            const Vec3 b = at_column(mesh.target(h));
            if (mesh.twin[h] >= 0 && std::abs(a.y()) + std::abs(b.y()) < 1e-6 &&
                std::max(a.x(), b.x()) < end + 0.5)
                seam[h] = 1;
        }
        for (std::size_t v = 0; v < cost.size(); ++v)
            cost[v] = 0.1 * (1.0 + std::round(at_column(static_cast<Index>(v)).x()));
    }
    Vec3 at_column(Index v) const { return mesh.points[v] * mesh.unit_length + Vec3(4, 0, 0); }
    Index cut_edges() const {
        Index number = 0;
        for (const std::uint8_t s : seam)
            number += s;
        return number / 2;
    }

    Mesh mesh;
    std::vector<std::uint8_t> seam;
    std::vector<double> cost;
};

TEST(SlitClosing, TheCostIsThatOfEquation6) {
    // From the tip at column 4: defects 0.5, 0.4, 0.3 … over edges of length 1. Closing l edges
    // costs Σ E(v_i) (l − i + 1).
    const double expected[] = {0.5, 0.5 * 2 + 0.4, 0.5 * 3 + 0.4 * 2 + 0.3,
                               0.5 * 4 + 0.4 * 3 + 0.3 * 2 + 0.2};
    for (int l = 1; l <= 4; ++l)
        for (const double side : {-1e-9, 1e-9}) {
            Slit slit(4);
            ASSERT_EQ(slit.cut_edges(), 4);
            const double threshold = (expected[l - 1] + side) / slit.mesh.unit_length;
            const atlas::ClosedSlits closed =
                atlas::close_slits(slit.mesh, slit.cost, threshold, slit.seam);
            EXPECT_EQ(closed.closed_edges, side > 0.0 ? l : l - 1);
            EXPECT_EQ(slit.cut_edges(), 4 - closed.closed_edges);
        }
}

TEST(SlitClosing, BordersAndTheLastCutOfAClosedChartStay) {
    const Mesh mesh = lumpy_sphere();
    const PapercraftResult r = segment(mesh, 1, 1000.0);
    EXPECT_EQ(r.charts.count, 1);
    expect_disks(mesh, r.charts);
    const PapercraftResult two = segment(mesh, 2, 1000.0);
    EXPECT_EQ(two.charts.count, 2);
    expect_disks(mesh, two.charts);
}

} // namespace
} // namespace devseg::papercraft
