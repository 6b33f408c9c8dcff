#include "devseg/flatten/maps/tutte.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;
using shapes::pi;

// The centre and the radius of the circle through the boundary.
std::pair<Vec2, double> circle(const Disk& disk, const std::vector<Vec2>& uv) {
    const std::vector<Index>& b = disk.problem.boundary;
    const Vec2& p = uv[b[0]];
    const Vec2& q = uv[b[b.size() / 3]];
    const Vec2& r = uv[b[2 * b.size() / 3]];
    Eigen::Matrix2d system;
    system << 2.0 * (q - p).transpose(), 2.0 * (r - p).transpose();
    const Vec2 centre = system.inverse() *
                        Vec2(q.squaredNorm() - p.squaredNorm(), r.squaredNorm() - p.squaredNorm());
    return {centre, (p - centre).norm()};
}

// What holds for every Tutte embedding whose boundary is on a circle.
void expect_embedding(const Disk& disk, const std::vector<Vec2>& uv) {
    ASSERT_EQ(uv.size(), disk.surface.vertex.size());
    EXPECT_EQ(checks::count_flips(disk.problem.faces, uv), 0);
    EXPECT_NEAR(map_area(disk.problem, uv), disk.problem.total_area,
                1e-9 * disk.problem.total_area);
    const auto [centre, radius] = circle(disk, uv);
    const std::vector<Index>& boundary = disk.problem.boundary;
    double turned = 0.0;
    for (std::size_t i = 0; i < boundary.size(); ++i) {
        const Vec2 p = uv[boundary[i]] - centre;
        const Vec2 q = uv[boundary[(i + 1) % boundary.size()]] - centre;
        EXPECT_NEAR(p.norm(), radius, 1e-9 * radius);
        const double turn = std::atan2(p.x() * q.y() - p.y() * q.x(), p.dot(q));
        turned += turn > 0.0 ? turn : turn + 2.0 * pi;
    }
    EXPECT_NEAR(turned, 2.0 * pi, 1e-6); // once around, and never back
}

TEST(Tutte, EveryMapIsAnEmbedding) {
    for (const mesh::RawMesh& raw :
         {shapes::grid(6, 4), shapes::hemisphere(16, 7), shapes::torus(16, 9), shapes::sphere(3),
          shapes::double_torus(), shapes::plate_with_handle(), shapes::cone(20, 6),
          shapes::moebius_strip(30, 3), shapes::plate(shapes::mask_with_holes(5)),
          shapes::with_noise(shapes::grid(20, 20), 0.02, 5), shapes::tetrahedron(),
          shapes::helix_strip(80, 2.5, 1.0, 2.0, 1.0)}) {
        const Disk disk(raw);
        expect_embedding(disk, flatten_tutte(disk.problem));
    }
}

TEST(Tutte, ArcsAreInProportionToTheEdges) {
    const Disk disk(shapes::grid(3, 2, 3.0, 8.0)); // edges of 1 and 4
    const std::vector<Vec2> uv = flatten_tutte(disk.problem);
    const auto [centre, radius] = circle(disk, uv);
    double length = 0.0;
    for (const double l : disk.problem.boundary_edge)
        length += l;
    for (std::size_t i = 0; i < disk.problem.boundary.size(); ++i) {
        const Vec2 p = uv[disk.problem.boundary[i]] - centre;
        const Vec2 q = uv[disk.problem.boundary[(i + 1) % disk.problem.boundary.size()]] - centre;
        EXPECT_NEAR(std::acos(p.dot(q) / (radius * radius)),
                    2.0 * pi * disk.problem.boundary_edge[i] / length, 1e-9);
    }
}

TEST(Tutte, InnerVerticesAreInTheHullOfTheirNeighbours) {
    const Disk disk(shapes::with_noise(shapes::hemisphere(12, 6), 0.05, 2));
    const std::vector<Vec2> uv = flatten_tutte(disk.problem);
    std::vector<std::vector<Vec2>> neighbours(uv.size());
    for (const Triangle& t : disk.problem.faces)
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t j = 1; j < 3; ++j)
                neighbours[t[k]].push_back(uv[t[(k + j) % 3]]);
    for (const Index v : disk.problem.boundary)
        neighbours[v].clear();
    for (std::size_t v = 0; v < uv.size(); ++v)
        for (int i = 0; i < 16 && !neighbours[v].empty(); ++i) {
            const Vec2 direction(std::cos(i * pi / 8.0), std::sin(i * pi / 8.0));
            double reach = -1e9;
            for (const Vec2& p : neighbours[v])
                reach = std::max(reach, direction.dot(p - uv[v]));
            EXPECT_GT(reach, 0.0);
        }
}

TEST(Tutte, HardChartsDoNotFlip) {
    std::vector<mesh::RawMesh> hard;
    hard.push_back(shapes::grid(400, 1, 400.0, 1.0)); // long strips
    hard.push_back(shapes::grid(300, 3, 300.0, 1.0));
    hard.push_back(shapes::grid(30, 30, 1.0, 1e-5)); // needles
    hard.push_back(shapes::grid(30, 30, 1.0, 1e-9));
    hard.push_back(shapes::finger(12, 20, 1.0, 10.0)); // much surface behind a short boundary
    hard.push_back(shapes::hemisphere(40, 40));
    mesh::RawMesh spikes = shapes::grid(20, 20);
    for (std::size_t v = 0; v < spikes.points.size(); v += 7)
        spikes.points[v].z() = 1e3;
    hard.push_back(spikes);
    mesh::RawMesh unbalanced = shapes::grid(24, 24); // sizes from 1 down to 2^-24
    for (Vec3& p : unbalanced.points)
        p.x() = std::exp2(-24.0 * p.x());
    hard.push_back(unbalanced);
    for (Vec3& p : unbalanced.points)
        p.y() = std::exp2(-24.0 * p.y());
    hard.push_back(unbalanced);
    hard.push_back(
        shapes::revolve({{1.0, 0.0}, {1e-7, 1.0}, {0.0, 1.0 + 1e-7}}, 50)); // a needle tip
    for (std::size_t i = 0; i < hard.size(); ++i) {
        const Disk disk(hard[i]);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, flatten_tutte(disk.problem)), 0)
            << "chart " << i;
    }
}

TEST(Tutte, FingersDoNotFlip) {
    // Behind a short boundary, distances in the map shrink by a constant factor for each ring of
    // faces: by e^-47 in all, here.
    const Disk disk(shapes::finger(8, 60, 1.0, 47.0));
    EXPECT_EQ(checks::count_flips(disk.problem.faces, flatten_tutte(disk.problem)), 0);
}

} // namespace
} // namespace devseg::flatten
