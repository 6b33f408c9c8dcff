#include "devseg/flatten/energy/vertex_relaxation.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/maps/lscm.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

// A bowl with one vertex pulled out a little: besides the stretch of the bowl, a flat map has a
// peak at one place.
checks::Disk spiked_plate() {
    mesh::RawMesh raw = shapes::grid(40, 40, 40.0, 40.0);
    for (Vec3& p : raw.points)
        p.z() = 0.012 * ((p.x() - 20.0) * (p.x() - 20.0) + (p.y() - 20.0) * (p.y() - 20.0));
    raw.points[20 * 41 + 12].z() += 1.0;
    return checks::Disk(raw);
}

double worst(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double largest = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        largest = std::max(largest, 1.0 / checks::stretches(problem, uv, f)[1]);
    return largest;
}

std::vector<Vec2> isometric(const FlatteningProblem& problem) {
    Progress progress;
    return minimise_symmetric_dirichlet(problem, flatten_lscm(problem), {}, progress).uv;
}

TEST(Peaks, TheWorstFaceIsRelievedAtLittleCost) {
    const checks::Disk disk = spiked_plate();
    const std::vector<Vec2> before = isometric(disk.problem);
    std::vector<Vec2> after = before;
    Progress progress;
    relieve_peaks(disk.problem, false, after, progress);
    EXPECT_LT(worst(disk.problem, after), worst(disk.problem, before) - 0.02);
    EXPECT_EQ(checks::count_flips(disk.problem.faces, after), 0);
    const double excess = symmetric_dirichlet_energy(disk.problem, before) - 1.0;
    EXPECT_LE(symmetric_dirichlet_energy(disk.problem, after) - 1.0, 1.25 * excess);
}

// The flat bottom of a rail that is bent sideways, with its rounded edges and walls: nearly
// isometric, with low peaks at the ends.
TEST(Peaks, LowPeaksOfNearlyIsometricMapsAreRelieved) {
    mesh::RawMesh raw = shapes::grid(40, 60, 40.0, 60.0);
    for (Vec3& p : raw.points) {
        const double across = std::clamp(p.x(), 10.0, 30.0);
        const double along = p.y() / 250.0;
        const double radius = 250.0 + across;
        const double down = std::abs(p.x() - across);
        p = {radius * std::cos(along), radius * std::sin(along), -down};
    }
    const checks::Disk disk(raw);
    const std::vector<Vec2> before = isometric(disk.problem);
    ASSERT_GT(worst(disk.problem, before), 1.01);
    ASSERT_LT(worst(disk.problem, before), 1.1);
    std::vector<Vec2> after = before;
    Progress progress;
    relieve_peaks(disk.problem, false, after, progress);
    EXPECT_LT(worst(disk.problem, after) - 1.0, 0.92 * (worst(disk.problem, before) - 1.0));
    EXPECT_EQ(checks::count_flips(disk.problem.faces, after), 0);
    const double excess = symmetric_dirichlet_energy(disk.problem, before) - 1.0;
    EXPECT_LE(symmetric_dirichlet_energy(disk.problem, after) - 1.0, 1.25 * excess);
}

TEST(Peaks, TheOutlineStaysWhereAsked) {
    const checks::Disk disk = spiked_plate();
    const std::vector<Vec2> before = isometric(disk.problem);
    std::vector<Vec2> after = before;
    Progress progress;
    relieve_peaks(disk.problem, true, after, progress);
    EXPECT_NE(after, before);
    for (const Index v : disk.problem.boundary)
        EXPECT_EQ(after[v], before[v]);
}

TEST(Peaks, AnIsometryStaysAsItIs) {
    const checks::Disk disk(shapes::grid(10, 10));
    const std::vector<Vec2> before = isometric(disk.problem);
    std::vector<Vec2> after = before;
    Progress progress;
    relieve_peaks(disk.problem, false, after, progress);
    EXPECT_EQ(after, before);
}

// A plate with a fold across: a row of needles pressed to a hundredth of their width, which single
// vertices cannot leave.
TEST(Peaks, NeedlesAreSettledTogether) {
    mesh::RawMesh raw = shapes::grid(60, 60, 60.0, 60.0);
    const auto index = [](Index x, Index y) { return at(y * 61 + x); };
    for (Index x = 26; x <= 34; ++x) // a row of low faces
        raw.points[index(x, 31)].y() -= 0.98;
    const checks::Disk disk(raw);
    const std::vector<Vec2> best = isometric(disk.problem);
    ASSERT_LT(worst(disk.problem, best), 1.001);
    std::vector<Vec2> before = best;
    for (Index x = 27; x <= 33; ++x) {
        const Vec2 across = best[index(x, 31)] - best[index(x, 30)];
        before[index(x, 31)] -= (x % 2 == 0 ? 0.99 : 0.9) * across;
    }
    ASSERT_EQ(checks::count_flips(disk.problem.faces, before), 0);
    ASSERT_GT(worst(disk.problem, before), 20.0);
    std::vector<Vec2> after = before;
    settle_peaks(disk.problem, after, Progress());
    EXPECT_EQ(checks::count_flips(disk.problem.faces, after), 0);
    EXPECT_LT(worst(disk.problem, after), 1.01);
    EXPECT_LT(symmetric_dirichlet_energy(disk.problem, after),
              symmetric_dirichlet_energy(disk.problem, before));
    for (const Index v : disk.problem.boundary)
        EXPECT_EQ(after[v], before[v]);
}

TEST(Peaks, EvenStretchIsNothingToSettle) {
    const checks::Disk disk(shapes::grid(10, 10));
    std::vector<Vec2> before = isometric(disk.problem);
    for (Vec2& p : before)
        p.x() *= 1.5;
    std::vector<Vec2> after = before;
    settle_peaks(disk.problem, after, Progress());
    EXPECT_EQ(after, before);
}

} // namespace
} // namespace devseg::flatten
