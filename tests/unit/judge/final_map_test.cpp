// Final maps, and those of charts that must stay in one piece.
#include "devseg/judge/final_map.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/maps/lscm.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::judge {
namespace {

// A square plate with a round hill in its middle. The energy of its map falls slowly.
mesh::RawMesh hill() {
    mesh::RawMesh raw = shapes::grid(40, 40, 2.0, 2.0);
    for (Vec3& p : raw.points)
        p.z() = std::exp(-6.0 * (p - Vec3(1.0, 1.0, 0.0)).squaredNorm());
    return raw;
}

double just_above(double l2) {
    return 1.0 + 1.01 * (l2 - 1.0);
}

TEST(WholeMaps, AreFinishedWhereAGuessOfTheirEnergyWouldRefuseThem) {
    const checks::Disk disk(hill());
    std::vector<Index> faces(disk.mesh.faces.size());
    std::iota(faces.begin(), faces.end(), 0);
    const std::vector<std::uint8_t> seam(disk.mesh.twin.size(), 0);
    Progress progress;
    const TrialMap free = whole_maps(disk.mesh, {faces}, seam, {}, progress).front();
    ASSERT_TRUE(free.flat);
    const double bound = just_above(std::sqrt(free.l2_squared));

    // After a few steps, gains are so small that a guess says: it never comes down to the bound.
    flatten::SymmetricDirichletOptions guess;
    guess.give_up_energy = bound * bound;
    flatten::SymmetricDirichletResult early = flatten::minimise_symmetric_dirichlet(
        disk.problem, flatten::flatten_lscm(disk.problem), guess, progress);
    flatten::scale_to_area(disk.problem, early.uv);
    EXPECT_FALSE(early.converged);
    EXPECT_GT(early.energy, guess.give_up_energy);
    EXPECT_GT(checks::l2_stretch(disk.problem, early.uv), bound);

    const TrialMap bounded = whole_maps(disk.mesh, {faces}, seam, {bound}, progress).front();
    EXPECT_TRUE(bounded.flat);
    EXPECT_EQ(bounded.l2_squared, free.l2_squared);
}

TEST(WholeMaps, OfJoinsAreFinishedAsWell) {
    declare::HostMesh host = checks::host_of(hill());
    for (const Triangle& t : host.geometry.faces) {
        host.chart_id.push_back(host.geometry.points[t[0]].x() < 1.0 ? 0.0 : 1.0);
        host.face_selected.push_back(1);
    }
    const char* const join = "Charts: Join Selected";
    const double l2 = checks::value(checks::run(join, host, {{"force", true}}), "l2_stretch");
    const declare::HostResult joined =
        checks::run(join, host, {{"max_chart_l2_stretch", just_above(l2)}});
    EXPECT_EQ(checks::value(joined, "charts_number"), 1);
    EXPECT_EQ(checks::value(joined, "l2_stretch"), l2);
}

} // namespace
} // namespace devseg::judge
