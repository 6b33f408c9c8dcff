// Faces that the gate has drawn to a line take part in all that hosts get.
#include <algorithm>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::declare {
namespace {

using checks::run;
using checks::value;

// A bent plate on which rows of vertices lie at the place of their neighbours: faces without area
// in chains, between others and at the border.
mesh::RawMesh creased_plate() {
    mesh::RawMesh raw = shapes::with_noise(shapes::grid(12, 12), 0.01, 3);
    for (Vec3& p : raw.points)
        p.z() = 0.3 * std::sin(5.0 * p.x()) * std::cos(4.0 * p.y());
    const auto join = [&](Index x, Index y, Index to_x) {
        raw.points[13 * y + x] = raw.points[13 * y + to_x];
    };
    for (const Index y : {3, 4, 5, 6})
        join(6, y, 5);
    for (const Index x : {2, 3})
        join(x, 9, 1); // three at one place
    join(1, 0, 0);
    return raw;
}

// Faces of the host that have no area, but three vertices.
std::vector<std::size_t> flat_faces(const mesh::RawMesh& raw) {
    std::vector<std::size_t> flat;
    for (std::size_t f = 0; f < raw.faces.size(); ++f)
        if (checks::area_on_surface(raw, f) == 0.0)
            flat.push_back(f);
    return flat;
}

TEST(CollapsedFaces, AgreeWithTheirNeighboursAndHaveAnArea) {
    for (const bool mixed : {false, true}) {
        mesh::RawMesh raw = creased_plate();
        if (mixed)
            raw = shapes::with_random_orientations(raw, 3);
        ASSERT_GE(flat_faces(raw).size(), 12U);
        HostMesh host = checks::host_of(raw);
        const HostResult charts =
            run("Segmentation: Variational Shape Approximation", host, {{"charts_number", 9}});
        checks::expect_agreement(raw, charts);
        checks::take_charts(host, charts);
        const HostResult flat = run("Charts: Flatten", host);
        checks::expect_agreement(raw, flat);
        const mesh::GatedMesh gated = mesh::gate_mesh(raw);
        for (const std::size_t f : flat_faces(raw)) {
            const bool turned = gated.flipped[gated.stand_in[f]] != 0;
            EXPECT_GT(checks::signed_area(flat.wedge_uv[f]) * (turned ? -1.0 : 1.0), 0.0) << f;
            EXPECT_LT(std::abs(checks::signed_area(flat.wedge_uv[f])), 1e-7) << f;
        }
    }
}

// Where no seam lies, readers of coordinates see none beside the collapsed faces either.
TEST(CollapsedFaces, HangTogetherWithTheirNeighboursInThePlane) {
    const mesh::RawMesh raw = creased_plate();
    const HostResult flat = run("Charts: Flatten", checks::host_of(raw));
    ASSERT_EQ(value(flat, "charts_number"), 1);
    for (const auto& [ends, faces] : checks::edges_of(raw))
        for (const Index v : ends) {
            const auto place = [&](std::size_t i) {
                const Triangle& t = raw.faces[faces[i].first];
                return flat.wedge_uv[faces[i].first][static_cast<std::size_t>(
                    std::find(t.begin(), t.end(), v) - t.begin())];
            };
            EXPECT_LT((place(0) - place(faces.size() - 1)).norm(), 5e-7);
        }
}

// A seam may lie on the edge between two faces that are read as one line.
TEST(CollapsedFaces, SeamsBetweenThemAreReadWhateverIsJoined) {
    const mesh::RawMesh raw = creased_plate();
    HostMesh host = checks::host_of(raw);
    const HostResult apart = run("Segmentation: Variational Shape Approximation", host,
                                 {{"charts_number", 9}, {"weld", -1.0}});
    checks::expect_agreement(raw, apart);
    checks::take_charts(host, apart);
    const HostResult read = run("Charts: Cut to Disks", host);
    checks::expect_agreement(raw, read);
    // One side alone, and nothing on the faces at the ends of the chain.
    host.chart_id.assign(raw.faces.size(), 0.0);
    host.seam_edges.assign(raw.faces.size(), 0.0);
    EXPECT_EQ(value(run("Charts: Measure Segmentation", host), "seam_length"), 0.0);
    for (const std::size_t f : flat_faces(raw)) {
        host.seam_edges.assign(raw.faces.size(), 0.0);
        host.seam_edges[f] = 7.0;
        double longest = 0.0;
        for (std::size_t k = 0; k < 3; ++k)
            longest = std::max(
                longest,
                (raw.points[raw.faces[f][k]] - raw.points[raw.faces[f][(k + 1) % 3]]).norm());
        EXPECT_NEAR(value(run("Charts: Measure Segmentation", host), "seam_length"), longest, 1e-9)
            << f;
    }
}

// The host's faces around them still share their vertices where they did.
TEST(CollapsedFaces, SplitFacesNearbyShareTheirNewVertices) {
    mesh::RawMesh raw = shapes::with_noise(shapes::torus(24, 14, 2.0, 0.9), 0.03, 4);
    raw.points[raw.faces[100][0]] = raw.points[raw.faces[100][1]];
    HostMesh host = checks::host_of(raw);
    checks::take_charts(host, run("Segmentation: D-Charts", host));
    const HostResult made = run("Charts: Smooth Seams", host);
    ASSERT_TRUE(made.refinement);
    const mesh::RawMesh fine = checks::refined(raw, made);
    Index alone = 0;
    for (const auto& [ends, faces] : checks::edges_of(fine))
        alone += faces.size() == 1 ? 1 : 0;
    EXPECT_LE(alone, 12); // beside the two faces without area
    host = checks::host_of(fine);
    checks::take_charts(host, made);
    const HostResult measured = run("Charts: Measure Segmentation", host);
    EXPECT_EQ(value(measured, "charts_number"), value(made, "charts_number"));
    EXPECT_NEAR(value(measured, "seam_length"), value(made, "seam_length"), 1e-9);
}

// Their vertices move with those at the same place.
TEST(CollapsedFaces, MoveWithTheirNeighbours) {
    mesh::RawMesh raw = shapes::hemisphere(10, 4);
    const auto first = static_cast<Index>(raw.points.size());
    const Triangle t = raw.faces[12];
    raw.points.push_back(raw.points[t[0]]); // of two needles alone
    raw.faces.push_back({t[0], first, t[1]});
    const HostResult r =
        run("Charts: Deform to Exact Developability", checks::host_of(raw),
            {{"keep_unfinished", true}, {"adjust_slits", false}, {"max_iterations", 3}});
    EXPECT_GT((r.points[at(t[0])] - raw.points[at(t[0])]).norm(), 1e-6);
    EXPECT_EQ(r.points[at(first)], r.points[at(t[0])]);
}

} // namespace
} // namespace devseg::declare
