#include "devseg/judge/cloth.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::judge {
namespace {

ClothTrial try_disk(const mesh::RawMesh& raw, const ClothLimits& limits) {
    const checks::Disk disk(raw);
    return try_cloth(disk.mesh, disk.surface.face, disk.charts.seam, limits, true, Progress{});
}

TEST(Cloth, TubesPassAndHemispheresDoNot) {
    for (const ClothLimits& limits :
         {ClothLimits{}, ClothLimits{0.15, 0.2, false}, ClothLimits{0.15, 0.0, true}}) {
        EXPECT_TRUE(try_disk(shapes::cylinder_tube(24, 8), limits).accepted);
        EXPECT_TRUE(try_disk(shapes::grid(6, 6), limits).accepted);
        EXPECT_FALSE(try_disk(shapes::hemisphere(32, 12), limits).accepted);
    }
}

TEST(Cloth, StrainHasABound) {
    mesh::RawMesh dome = shapes::grid(24, 24, 1.0, 1.0);
    for (Vec3& p : dome.points)
        p.z() = 0.55 * std::exp(-4.0 * (p.x() * p.x() + p.y() * p.y()));
    const ClothTrial strict = try_disk(dome, {0.15, 0.02, false});
    const ClothTrial loose = try_disk(dome, {0.15, 0.6, false});
    EXPECT_FALSE(strict.accepted);
    EXPECT_TRUE(loose.accepted);
    EXPECT_GT(strict.strain.most_of_it, 0.02);
    EXPECT_DOUBLE_EQ(strict.strain.worst, loose.strain.worst);
    EXPECT_GE(strict.strain.worst, strict.strain.most_of_it);
    EXPECT_GT(strict.strain.most_of_it, strict.strain.mean);
    EXPECT_EQ(strict.strains.size(), strict.face.size());
}

// Equations of conformal maps are singular there; the answer is a map all the same.
TEST(Cloth, NeedlesAreMapped) {
    for (const double height : {1e-5, 1e-9, 1e-11, 1e-13})
        for (const double max_strain : {0.0, 0.2}) {
            const ClothTrial trial = try_disk({{{0, 0, 0}, {1, 0, 0}, {0, height, 0}}, {{0, 1, 2}}},
                                              {0.15, max_strain, true});
            ASSERT_EQ(trial.change.size(), 1U);
            EXPECT_TRUE(std::isfinite(trial.change[0])) << height;
        }
}

} // namespace
} // namespace devseg::judge
