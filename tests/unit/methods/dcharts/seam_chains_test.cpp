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

void expect_same(const std::vector<Closing>& found, const std::vector<Closing>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].charts, expected[i].charts);
        EXPECT_EQ(found[i].edges, expected[i].edges);
    }
}

// What it remembers from one time to the next changes nothing.
TEST(SeamChains, AreTheSameAfterJoinsAndOpenedCuts) {
    const Mesh mesh = checks::gated(shapes::grid(9, 9));
    std::vector<Index> label;
    for (const Vec3& p : mesh.face_centers)
        label.push_back((p.x() < -0.2 ? 0 : p.x() < 0.2 ? 1 : 2) + (p.y() < 0.1 ? 0 : 3));
    Draft draft = make_untried_draft(mesh, label);
    SeamChains chains(mesh, false);
    std::vector<std::size_t> counts;
    for (const Index gone : {4, 1, 5, 2}) {
        const std::vector<Closing> found = chains.find(draft);
        counts.push_back(found.size());
        expect_same(found, SeamChains(mesh, false).find(draft));
        const Index into = gone > 2 ? 3 : 0;
        std::vector<Index> opened; // an edge within the joined chart
        for (Index& l : draft.chart)
            l = l == gone ? into : l;
        for (const HalfEdge h : mesh.all_half_edges())
            if (opened.empty() && mesh.twin[h] > h && label[face_of(h)] == gone &&
                draft.chart[mesh.across(h)] == into)
                opened.push_back(h);
        ASSERT_EQ(opened.size(), 1U);
        draft.seam[at(opened[0])] = draft.seam[at(mesh.twin[at(opened[0])])] = 1;
        chains.open(opened);
        expect_same(chains.find(draft), SeamChains(mesh, false).find(draft));
    }
    EXPECT_NE(counts.front(), counts.back());
}

} // namespace
} // namespace devseg::dcharts
