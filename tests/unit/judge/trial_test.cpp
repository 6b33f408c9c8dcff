#include "devseg/judge/trial.h"

#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "devseg/judge/final_map.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::judge {

namespace {

// Like a spiral staircase three faces wide: laid flat, it runs over itself from the second turn on.
Mesh staircase(double turns) {
    mesh::RawMesh raw = shapes::grid(60, 3);
    Eigen::AlignedBox3d box;
    for (const Vec3& p : raw.points)
        box.extend(p);
    for (Vec3& p : raw.points) {
        const Vec3 share = (p - box.min()).cwiseQuotient(box.sizes().cwiseMax(1.0e-9));
        const double angle = 2.0 * pi * turns * share.x();
        const double radius = 1.0 + 0.5 * share.y();
        p = Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.2 * turns * share.x());
    }
    return checks::gated(raw);
}

TEST(Trial, ChartsThatLieOnThemselvesAreRefusedWhereThatIsAskedFor) {
    Progress progress;
    for (const double turns : {0.5, 1.5}) {
        const Mesh mesh = staircase(turns);
        std::vector<Index> faces(mesh.faces.size());
        std::iota(faces.begin(), faces.end(), 0);
        const std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
        TrialEffort effort;
        const TrialMap any = try_chart(mesh, faces, seam, effort, progress);
        ASSERT_TRUE(any.flat) << turns;
        EXPECT_EQ(any.overlaps, turns > 1.0);
        effort.only_apart = true;
        EXPECT_EQ(try_chart(mesh, faces, seam, effort, progress, any.turns).flat, turns < 1.0);
    }
}

TEST(Trial, ChartsWhoseCutsAreTooLongAreRefused) {
    Progress progress;
    const Mesh mesh = checks::gated(shapes::cylinder_tube(24, 6));
    std::vector<Index> faces(mesh.faces.size());
    std::iota(faces.begin(), faces.end(), 0);
    const std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    TrialEffort effort;
    const TrialMap any = try_chart(mesh, faces, seam, effort, progress);
    ASSERT_TRUE(any.flat);
    ASSERT_GT(any.cut_length, 0.0);
    for (const double share : {0.9, 1.1}) {
        effort.most_cut_length = share * any.cut_length;
        const TrialMap map = try_chart(mesh, faces, seam, effort, progress);
        EXPECT_EQ(map.flat, share > 1.0);
        EXPECT_EQ(map.cut_length, any.cut_length);
    }
}

// Seams that have moved may take a chart apart: that is for flattening to tell.
TEST(FinalMap, NothingIsSureOfAChartInTwoParts) {
    const Mesh mesh = checks::gated(shapes::grid(4, 4));
    std::vector<Index> faces;
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    for (const Face f : mesh.all_faces())
        faces.push_back(f);
    EXPECT_TRUE(is_surely_within(mesh, faces, seam, 1.01, Progress()));
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && mesh.points[mesh.origin(h)].x() == 0.0 &&
            mesh.points[mesh.target(h)].x() == 0.0)
            seam[h] = 1;
    EXPECT_FALSE(is_surely_within(mesh, faces, seam, 1.01, Progress()));
}

} // namespace

} // namespace devseg::judge
