// Seams are chains of edges, which end where parts of them may be closed.
#include "devseg/methods/dcharts/seam_chains.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

// A square chart in the middle of a plate.
Draft island(const Mesh& mesh) {
    std::vector<Index> label;
    for (const Vec3& p : mesh.face_centers)
        label.push_back(std::max(std::abs(p.x()), std::abs(p.y())) < 0.24 ? 1 : 0);
    return make_untried_draft(mesh, label);
}

TEST(SeamChains, LoopsBeginWhereTheyMay) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    const std::vector<Closing> chains = SeamChains(mesh, false).find(island(mesh));
    ASSERT_EQ(chains.size(), 1U);
    const std::vector<Index>& loop = chains.front().edges;
    ASSERT_EQ(loop.size(), 16U);
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vertex only = vertex_between(mesh, loop[i], loop[(i + 1) % loop.size()]);
        std::vector<Index> turned = loop;
        begin_loop_at(
            mesh, [&](Vertex v) { return v == only; }, turned);
        EXPECT_EQ(vertex_between(mesh, turned.back(), turned.front()), only);
        EXPECT_TRUE(std::is_permutation(turned.begin(), turned.end(), loop.begin()));
        for (std::size_t k = 1; k < turned.size(); ++k) // still one after the other
            EXPECT_EQ(vertex_between(mesh, turned[k - 1], turned[k]),
                      vertex_between(mesh, turned[k], turned[k - 1]));
    }
}

TEST(SeamChains, ChainsWithTwoEndsStay) {
    const Mesh mesh = checks::gated(shapes::grid(8, 8));
    std::vector<Index> label;
    for (const Vec3& p : mesh.face_centers)
        label.push_back(p.x() < 0.0 ? 0 : 1);
    const std::vector<Closing> chains =
        SeamChains(mesh, false).find(make_untried_draft(mesh, label));
    ASSERT_EQ(chains.size(), 1U);
    std::vector<Index> turned = chains.front().edges;
    ASSERT_EQ(turned.size(), 8U);
    begin_loop_at(
        mesh, [&](Vertex) { return false; }, turned);
    EXPECT_EQ(turned, chains.front().edges);
    begin_loop_at(
        mesh, [&](Vertex) { return true; }, turned);
    EXPECT_EQ(turned, chains.front().edges);
}

} // namespace
} // namespace devseg::dcharts
