#include "devseg/flatten/repair/slits.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

// A plate with a slit along its middle, and rows of this height (shares of the gap) beside it.
struct Plate {
    explicit Plate(double height)
        : disk(squeezed(height),
               [](const Vec3& p) { return std::abs(p.y()) < 1e-9 && std::abs(p.x()) < 0.3; }),
          gap(slit_gap * disk.problem.model_size) {
        for (const Vertex v : disk.surface.vertex)
            uv.emplace_back(disk.mesh.points[v].head<2>());
    }
    static mesh::RawMesh squeezed(double height) {
        mesh::RawMesh raw = shapes::grid(24, 8, 24.0, 8.0);
        for (Vec3& p : raw.points)
            if (std::abs(std::abs(p.y() - 4.0) - 1.0) < 0.1)
                p.y() = 4.0 + (p.y() - 4.0) * height * slit_gap * std::sqrt(24.0 * 8.0);
        return raw;
    }
    // Of corners of the mesh that lie at two places.
    double widest_slit() const {
        double widest = 0.0;
        for (std::size_t v = 0; v < uv.size(); ++v)
            for (std::size_t w = 0; w < v; ++w)
                if (disk.surface.vertex[v] == disk.surface.vertex[w])
                    widest = std::max(widest, (uv[v] - uv[w]).norm());
        return widest;
    }

    checks::Disk disk;
    double gap;
    std::vector<Vec2> uv;
};

TEST(Slits, OpenByTheGap) {
    Plate plate(1000.0);
    ASSERT_EQ(plate.widest_slit(), 0.0);
    open_closed_slits(plate.disk.mesh, plate.disk.surface, plate.gap, plate.uv);
    EXPECT_NEAR(plate.widest_slit(), plate.gap, 1e-6 * plate.gap);
    EXPECT_EQ(checks::count_flips(plate.disk.problem.faces, plate.uv), 0);
}

// In a small chart of a large model the gap is as wide as faces are high.
TEST(Slits, DoNotSquashTheFacesBesideThem) {
    for (const double height : {0.3, 0.6, 2.0}) {
        Plate plate(height);
        open_closed_slits(plate.disk.mesh, plate.disk.surface, plate.gap, plate.uv);
        EXPECT_GT(plate.widest_slit(), 0.05 * plate.gap) << height;
        EXPECT_GT(least_area_ratio(plate.disk.problem, plate.uv), 0.85) << height;
    }
}

} // namespace
} // namespace devseg::flatten
