#include "devseg/atlas/fragments.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::atlas {
namespace {

TEST(Fragments, SmallPiecesGoToTheNeighbourWithTheLongestBorder) {
    const Mesh mesh = checks::gated(shapes::grid(20, 20));
    std::vector<Index> label;
    for (const Vec3& centre : mesh.face_centers)
        label.push_back(centre.x() < 0.0 ? 0 : 1);
    label[5] = 7; // one face, all of whose neighbours have the same label
    const std::vector<Index> result = absorb_fragments(mesh, label, 0.01);
    EXPECT_EQ(1 + *std::max_element(result.begin(), result.end()), 2);
    for (Index h = 15; h < 18; ++h)
        if (mesh.twin[h] >= 0) {
            EXPECT_EQ(result[5], result[mesh.twin[h] / 3]);
        }
}

TEST(Fragments, PiecesWithoutNeighboursAndLargeOnesStay) {
    mesh::RawMesh raw = shapes::grid(10, 10);
    const Index base = static_cast<Index>(raw.points.size());
    for (const Vec3& p : {Vec3(5, 5, 5), Vec3(5.01, 5, 5), Vec3(5, 5.01, 5)})
        raw.points.push_back(p);
    raw.faces.push_back({base, base + 1, base + 2});
    const Mesh mesh = checks::gated(raw);
    const std::vector<Index> label(mesh.faces.size(), 3);
    const std::vector<Index> result = absorb_fragments(mesh, label, 0.5);
    EXPECT_EQ(result.front(), 0);
    EXPECT_EQ(result.back(), 1);
}

TEST(Fragments, TeethGo) {
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
} // namespace devseg::atlas
