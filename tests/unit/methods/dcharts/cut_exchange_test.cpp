// Cuts inside charts in shorter places.
#include "devseg/methods/dcharts/cut_exchange.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/methods/dcharts/joins.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

// Marks the edges that lie on x = `at_x`, between two heights.
void cut(const Mesh& mesh, double at_x, double from, double to, Draft& draft) {
    const auto is_on = [&](Vertex v) {
        const Vec3& p = mesh.points[v];
        return std::abs(p.x() - at_x) < 1e-9 && p.y() > from - 1e-9 && p.y() < to + 1e-9;
    };
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && is_on(mesh.origin(h)) && is_on(mesh.target(h)))
            draft.seam[h] = draft.seam[mesh.twin[h]] = 1;
}

double length(const Mesh& mesh, const std::vector<Index>& edges) {
    double sum = 0.0;
    for (const HalfEdge h : edges)
        sum += mesh.edge_length(h);
    return sum;
}

struct Sheet {
    Mesh mesh = checks::gated(shapes::grid(20, 20, 1.0, 1.0));
    Draft draft = make_untried_draft(mesh, std::vector<Index>(mesh.faces.size(), 0));
    Vec3 low = mesh.points.front();
    double side = 0.0;

    Sheet() {
        Vec3 high = low;
        for (const Vec3& p : mesh.points) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        side = high.x() - low.x();
    }
    // In shares of the side.
    void mark(double x, double from, double to) {
        cut(mesh, low.x() + x * side, low.y() + from * side, low.y() + to * side, draft);
    }
    std::vector<Closing> chains() const { return SeamChains(mesh, false).find(draft); }
};

TEST(CutExchange, ADartBeginsAtTheNearestBorder) {
    Sheet sheet;
    sheet.mark(0.5, 0.0, 0.9);
    const std::vector<Closing> chains = sheet.chains();
    ASSERT_EQ(chains.size(), 1U);
    const std::vector<Index> path = shorter_cut(sheet.mesh, sheet.draft, chains[0], Progress());
    EXPECT_NEAR(length(sheet.mesh, path), 0.1 * sheet.side, 1e-9);
    Draft draft = sheet.draft;
    for (const HalfEdge h : chains[0].edges)
        draft.seam[h] = draft.seam[sheet.mesh.twin[h]] = 0;
    for (const HalfEdge h : path)
        draft.seam[h] = draft.seam[sheet.mesh.twin[h]] = 1;
    EXPECT_EQ(SeamChains(sheet.mesh, false).find(draft).size(), 1U);
    EXPECT_TRUE(atlas::extract_surface(sheet.mesh, draft.faces[0], draft.seam).is_disk());
}

TEST(CutExchange, KeepsClearOfHoles) {
    // The straight way up from the dart's tip leads to a hole that closes at x = 0.5.
    Sheet sheet;
    sheet.mark(0.5, 0.0, 0.8);
    const Closing chain = sheet.chains().at(0);
    sheet.mark(0.5, 0.85, 0.95);
    const std::vector<Index> path = shorter_cut(sheet.mesh, sheet.draft, chain, Progress());
    ASSERT_FALSE(path.empty());
    Draft draft = sheet.draft;
    for (const HalfEdge h : chain.edges)
        draft.seam[h] = draft.seam[sheet.mesh.twin[h]] = 0;
    for (const HalfEdge h : path)
        draft.seam[h] = draft.seam[sheet.mesh.twin[h]] = 1;
    EXPECT_EQ(atlas::extract_surface(sheet.mesh, draft.faces[0], draft.seam).loops.size(), 2U);
}

TEST(CutExchange, TheShortestCutStays) {
    Sheet sheet;
    sheet.mark(0.5, 0.0, 0.4);
    EXPECT_TRUE(shorter_cut(sheet.mesh, sheet.draft, sheet.chains().at(0), Progress()).empty());
}

TEST(CutExchange, WhatHangsTogetherWithoutTheChainNeedsNoOtherOne) {
    Sheet sheet;
    sheet.mark(0.5, 0.0, 1.0); // from rim to rim, and the rim is one
    EXPECT_TRUE(shorter_cut(sheet.mesh, sheet.draft, sheet.chains().at(0), Progress()).empty());
}

TEST(Joins, StepsGoOnFromEachOther) {
    const Mesh mesh = checks::gated(shapes::sphere(3));
    std::vector<Index> octant;
    for (const Vec3& c : mesh.face_centers)
        octant.push_back((c.x() > 0.0 ? 1 : 0) + (c.y() > 0.0 ? 2 : 0) + (c.z() > 0.0 ? 4 : 0));
    Progress progress;
    MergeOptions options;
    options.chart = {1.1, 5.0};
    options.least_neck = 0.0;
    const Draft start = make_draft(mesh, octant, {}, 1.1, progress);
    const double most = 20.0 * start.excess();
    const std::vector<Draft> steps =
        merge_charts_in_steps(mesh, options, {0.0, 0.5 * most, most}, start, progress);
    ASSERT_EQ(steps.size(), 3U);
    EXPECT_EQ(steps[0].joins, 0);
    EXPECT_GT(steps[1].joins, 0);
    EXPECT_GE(steps[2].joins, steps[1].joins);
    EXPECT_LE(steps[1].excess(), 0.5 * most);
    EXPECT_LE(steps[2].excess(), most);
    EXPECT_GE(steps[2].excess(), steps[1].excess());
}

} // namespace
} // namespace devseg::dcharts
