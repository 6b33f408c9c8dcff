// Parts of developments that lie on others and go to a neighbouring chart.
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/develop/moved_parts.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/repair/overlaps.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::develop {
namespace {

constexpr Index sectors = 17; // one more than fit around the middle
constexpr Index rows = 8;

// A folded fan that lies on itself in the plane, in one chart, and a sheet at either end, each a
// chart. The ends are bent, so that no part fits exactly to a sheet along more than an edge.
struct FanWithSheets {
    FanWithSheets() {
        mesh::RawMesh raw = shapes::zigzag_fan(sectors, shapes::pi / 8.0, 1.0, 2.0, rows);
        const std::size_t fan = raw.faces.size();
        add_sheet(raw, sectors, Vec3(0.5, 0.1, 0.2), true);
        const std::size_t first = raw.faces.size();
        add_sheet(raw, 0, Vec3(0.5, -0.1, 0.2), false);
        mesh = checks::gated(raw);
        std::vector<Index> label(raw.faces.size(), 0);
        for (std::size_t f = fan; f < label.size(); ++f)
            label[f] = f < first ? 1 : 2;
        for (Index v = 0; v < mesh.vertex_count(); ++v)
            point_of.push_back(v);
        Progress progress;
        result = deform_to_developable(mesh, atlas::make_chart_map(mesh, label, {}, false),
                                       point_of, options, progress);
    }

    static void add_sheet(mesh::RawMesh& raw, Index ray, const Vec3& offset, bool ascending) {
        const Index n = static_cast<Index>(raw.points.size());
        const auto on_ray = [&](Index row) { return row * (sectors + 1) + ray; };
        for (Index row = 0; row <= rows; ++row) {
            Vec3& p = raw.points[at(on_ray(row))];
            p += 0.01 * std::sin(shapes::pi * row / rows) * offset;
            raw.points.push_back(p + offset);
        }
        for (Index row = 0; row < rows; ++row) {
            const Index a = on_ray(row);
            const Index b = on_ray(row + 1);
            if (ascending) {
                raw.faces.push_back({a, n + row, b});
                raw.faces.push_back({n + row, n + row + 1, b});
            } else {
                raw.faces.push_back({a, b, n + row});
                raw.faces.push_back({n + row, b, n + row + 1});
            }
        }
    }

    Index parts() const {
        Mesh now = mesh;
        now.points = result.points;
        mesh::compute_face_geometry(now);
        Progress progress;
        const flatten::FlattenResult flat = flatten::flatten_charts(
            now, result.charts, flatten::FlattenMethod::symmetric_dirichlet, progress);
        for (const flatten::FlatChart& chart : flat.flat)
            EXPECT_TRUE(chart.developed);
        return flat.charts.count;
    }

    Mesh mesh;
    std::vector<Index> point_of;
    DeformOptions options;
    DeformResult result;
};

TEST(MovedParts, GoToANeighbourAndAreDeformedOnceMore) {
    FanWithSheets fan;
    ASSERT_TRUE(fan.result.converged);
    ASSERT_EQ(fan.result.charts.count, 3);
    ASSERT_EQ(fan.parts(), 4);
    Progress progress;
    move_parts(fan.mesh, fan.point_of, fan.options, fan.result, progress);
    EXPECT_EQ(fan.result.moved_parts, 1);
    EXPECT_EQ(fan.result.charts.count, 3);
    EXPECT_TRUE(checks::is_valid(fan.mesh, fan.result.charts));
    EXPECT_LE(fan.result.residual, fan.options.tolerance);
    EXPECT_EQ(fan.parts(), 3);
    double largest = 0.0;
    for (std::size_t v = 0; v < fan.mesh.points.size(); ++v)
        largest = std::max(largest, (fan.result.points[v] - fan.mesh.points[v]).norm());
    EXPECT_DOUBLE_EQ(fan.result.largest_displacement, largest);
}

TEST(MovedParts, StayWhereVerticesWouldMoveTooFar) {
    FanWithSheets fan;
    fan.options.max_displacement = 1e-9; // no gap may be bridged
    Progress progress;
    move_parts(fan.mesh, fan.point_of, fan.options, fan.result, progress);
    EXPECT_EQ(fan.result.moved_parts, 0);
    EXPECT_EQ(fan.result.charts.count, 4); // apart, as flattening would have it
}

} // namespace
} // namespace devseg::develop
