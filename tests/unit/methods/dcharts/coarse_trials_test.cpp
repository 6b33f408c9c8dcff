// Trials on a coarse surface say what those on the surface itself do.
#include "devseg/methods/dcharts/coarse_trials.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

// Strips of a surface around the z axis.
std::vector<Index> sectors(const Mesh& mesh, Index count) {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : mesh.points)
        centre += p / static_cast<double>(mesh.points.size());
    std::vector<Index> label;
    for (const Face f : mesh.all_faces()) {
        const Vec3 p = mesh.face_centers[f] - centre;
        const double turn = std::atan2(p.y(), p.x()) / (2.0 * pi) + 0.5;
        label.push_back(std::min(count - 1, static_cast<Index>(turn * count)));
    }
    return label;
}

std::vector<Closing> whole_borders(const Mesh& mesh, const Draft& draft) {
    std::vector<Closing> closings;
    for (Closing& chain : SeamChains(mesh, false).find(draft)) {
        if (!closings.empty() && closings.back().charts == chain.charts)
            closings.back().edges.insert(closings.back().edges.end(), chain.edges.begin(),
                                         chain.edges.end());
        else
            closings.push_back(std::move(chain));
    }
    return closings;
}

TEST(CoarseTrials, AgreeWithThoseOnTheSurface) {
    const Mesh mesh = checks::gated(shapes::hemisphere(120, 60));
    Progress progress;
    const Draft draft = make_draft(mesh, sectors(mesh, 6), {}, 1.01, progress);
    ASSERT_TRUE(CoarseTrials::pay(mesh, draft));
    const CoarseTrials coarse(mesh, draft, std::vector<std::uint8_t>(mesh.points.size(), 0), 1.01,
                              progress);
    judge::TrialEffort effort;
    effort.wanted_l2 = 1.01;
    const std::vector<Closing> closings = whole_borders(mesh, draft);
    ASSERT_GE(closings.size(), 6U);
    for (const Closing& closing : closings) {
        const judge::TrialMap found = coarse.try_closing(closing, draft.seam, effort, {}, progress);
        const judge::TrialMap expected = judge::try_chart(mesh, united_faces(draft, closing.charts),
                                                          draft.seam, effort, progress);
        EXPECT_EQ(found.flat, expected.flat);
        EXPECT_LT(found.turns.size(), expected.turns.size() / 2);
        EXPECT_NEAR(found.area, expected.area, 0.02 * expected.area);
        EXPECT_GT(expected.l2_squared, 1.001);
        EXPECT_NEAR(found.l2_squared - 1.0, expected.l2_squared - 1.0,
                    0.2 * (expected.l2_squared - 1.0));
    }
}

TEST(CoarseTrials, GoOnWithJoinedCharts) {
    const Mesh mesh = checks::gated(shapes::cylinder_tube(240, 40));
    Progress progress;
    Draft draft = make_draft(mesh, sectors(mesh, 4), {}, 1.01, progress);
    CoarseTrials coarse(mesh, draft, std::vector<std::uint8_t>(mesh.points.size(), 0), 1.01,
                        progress);
    judge::TrialEffort effort;
    for (int joins = 0; joins < 3; ++joins) {
        const Closing closing = whole_borders(mesh, draft).front();
        const auto [a, b] = closing.charts;
        judge::TrialMap map = coarse.try_closing(closing, draft.seam, effort, {}, progress);
        EXPECT_TRUE(map.flat);
        EXPECT_NEAR(map.l2_squared, 1.0, 1e-4); // a tube unrolls
        coarse.close(closing.charts, std::move(map));
        draft.faces[a] = united_faces(draft, closing.charts);
        draft.faces[b].clear();
        for (const Face f : draft.faces[a])
            draft.chart[f] = a;
    }
    EXPECT_EQ(coarse.map(0).turns.empty(), false);
}

} // namespace
} // namespace devseg::dcharts
