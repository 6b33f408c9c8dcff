#include "devseg/pattern/sewn_preview.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/area_balance.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/maps/lpfb.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/maps/tutte.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::pattern {
namespace {

// Every face on its own, with its true shape, far from the others.
CornerUv loose_faces(const Mesh& mesh, double scale) {
    CornerUv uv;
    for (const Face f : mesh.all_faces()) {
        const flatten::RestTriangle rest = flatten::make_rest_triangle(
            {mesh.edge_length(3 * f), mesh.edge_length(3 * f + 1), mesh.edge_length(3 * f + 2)},
            0.0);
        const Vec2 place(3.0 * (f % 40), 3.0 * (f / 40));
        uv.push_back(scale * place);
        uv.push_back(scale * (place + rest.edges.col(0)));
        uv.push_back(scale * (place + rest.edges.col(1)));
    }
    return uv;
}

TEST(SewnPreview, ExactPiecesBecomeTheModel) {
    const Mesh mesh = checks::gated(shapes::sphere(3));
    Progress progress;
    SewnOptions options;
    options.stuffing = 0.005;
    const SewnPreview preview = sew_and_inflate(mesh, loose_faces(mesh, 0.3), options, progress);
    EXPECT_LT(preview.mean_distance, 0.005);
    EXPECT_TRUE(preview.converged);
}

TEST(SewnPreview, MoreStuffingMakesLargerToys) {
    const Mesh mesh = checks::gated(shapes::sphere(3));
    const CornerUv uv = loose_faces(mesh, 1.0);
    const auto mean_radius = [&](double stuffing) {
        SewnOptions options;
        options.stuffing = stuffing;
        Progress progress;
        double sum = 0.0;
        const SewnPreview preview = sew_and_inflate(mesh, uv, options, progress);
        for (const Vec3& p : preview.points)
            sum += p.norm();
        return sum / static_cast<double>(preview.points.size());
    };
    const double little = mean_radius(0.01);
    const double much = mean_radius(0.05);
    // The net stretches about as far as asked.
    EXPECT_GT(much / little, 1.02);
    EXPECT_LT(much / little, 1.09);
}

TEST(SewnPreview, LongerPiecesAreMissedByMore) {
    const Mesh mesh = checks::gated(shapes::capped_cylinder(24, 24));
    CornerUv uv = loose_faces(mesh, 1.0);
    Progress progress;
    const double exact = sew_and_inflate(mesh, uv, {}, progress).mean_distance;
    for (const Face f : mesh.all_faces()) // the upper half of the cloth is too long one way
        for (Index k = 1; k < 3; ++k)
            if (mesh.face_centers[f].z() > 0.0) {
                const Vec2 side = uv[3 * f + k] - uv[3 * f];
                uv[3 * f + k] = uv[3 * f] + Vec2(1.8 * side.x(), side.y() / 1.8);
            }
    EXPECT_GT(sew_and_inflate(mesh, uv, {}, progress).mean_distance, 2.0 * exact);
}

TEST(SewnPreview, Cancels) {
    const Mesh mesh = checks::gated(shapes::sphere(3));
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW(sew_and_inflate(mesh, loose_faces(mesh, 1.0), {}, progress), Cancelled);
}

TEST(SewnPreview, LongFacesTakeLessStuffing) {
    // A tube 100,000 times as long as wide, of two faces to each side: the pressure on its faces is
    // more than its edges hold.
    const Mesh tube = checks::gated(shapes::cylinder_tube(12, 1, 1.0, 1e5));
    Progress progress;
    const CornerUv uv = loose_faces(tube, 1.0);
    const SewnPreview preview = sew_and_inflate(tube, uv, {}, progress);
    EXPECT_LT(preview.stuffing, SewnOptions{}.stuffing);
    EXPECT_LT(preview.largest_distance, 0.1);
    const Mesh ball = checks::gated(shapes::sphere(3));
    EXPECT_EQ(sew_and_inflate(ball, loose_faces(ball, 1.0), {}, progress).stuffing,
              SewnOptions{}.stuffing);
}

TEST(AreaBalance, EvensAreasOutAndKeepsTheBoundary) {
    const checks::Disk disk(shapes::grid(12, 12));
    std::vector<Vec2> uv = flatten::flatten_tutte(disk.problem);
    std::vector<Vec2> square(uv.size());
    for (std::size_t v = 0; v < uv.size(); ++v)
        square[v] = disk.mesh.points[disk.surface.vertex[v]].head<2>();
    uv = square;
    for (std::size_t v = 0; v < uv.size(); ++v) { // a bulge inside
        const Vec2 p = square[v];
        uv[v] += 0.4 * (0.25 - p.x() * p.x()) * (0.25 - p.y() * p.y()) * 4.0 * p;
    }
    const double before = flatten::measure_area_change(disk.problem, uv).largest();
    ASSERT_GT(before, 0.15);
    std::vector<Vec2> balanced = uv;
    flatten::balance_areas(disk.problem, balanced, Progress{});
    EXPECT_LT(flatten::measure_area_change(disk.problem, balanced).largest(), 0.12);
    EXPECT_EQ(checks::count_flips(disk.problem.faces, balanced), 0);
    for (const Index v : disk.problem.boundary)
        EXPECT_EQ(balanced[v], uv[v]);
    // What is even already stays.
    std::vector<Vec2> even = square;
    flatten::balance_areas(disk.problem, even, Progress{});
    EXPECT_EQ(even, square);
}

TEST(AreaBalance, ABoundaryThatMayBendTakesMore) {
    // A strip around a ball: its middle is longer than its edges.
    mesh::RawMesh strip = shapes::grid(40, 12, 2.4, 1.0);
    for (Vec3& p : strip.points)
        p = {std::cos(p.y()) * std::cos(p.x()), std::cos(p.y()) * std::sin(p.x()), std::sin(p.y())};
    const checks::Disk disk(strip);
    std::vector<Vec2> uv = flatten::flatten_lscm(disk.problem);
    flatten::scale_to_area(disk.problem, uv);
    std::vector<Vec2> fixed = uv;
    flatten::balance_areas(disk.problem, fixed, Progress{});
    const std::vector<Vec2> bent = flatten::balance_with_boundary(disk.problem, uv, Progress{});
    const auto change = [&](const std::vector<Vec2>& map) {
        return flatten::measure_area_change(disk.problem, map).largest();
    };
    EXPECT_EQ(checks::count_flips(disk.problem.faces, bent), 0);
    EXPECT_LT(change(bent), 0.5 * change(fixed));
    for (std::size_t i = 0; i < disk.problem.boundary.size(); ++i) {
        const Index v = disk.problem.boundary[i];
        const Index u = disk.problem.boundary[(i + 1) % disk.problem.boundary.size()];
        EXPECT_NEAR((bent[u] - bent[v]).norm(), disk.problem.boundary_edge[i],
                    0.03 * disk.problem.boundary_edge[i]);
    }
}

} // namespace
} // namespace devseg::pattern
