#include "devseg/flatten/energy/strain.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/maps/lpfb_map.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/overlap.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;

mesh::RawMesh saddle(double height) {
    mesh::RawMesh raw = shapes::grid(20, 20, 1.0, 1.0);
    for (Vec3& p : raw.points)
        p.z() = height * p.x() * p.y();
    return raw;
}

mesh::RawMesh dome(double height) {
    mesh::RawMesh raw = shapes::grid(20, 20, 1.0, 1.0);
    for (Vec3& p : raw.points)
        p.z() = height * std::exp(-4.0 * (p.x() * p.x() + p.y() * p.y()));
    return raw;
}

// A plate as it is.
std::vector<Vec2> laid_flat(const Disk& disk) {
    std::vector<Vec2> uv;
    for (const Vertex v : disk.surface.vertex)
        uv.emplace_back(disk.mesh.points[v].head<2>());
    return uv;
}

TEST(Strain, IsHowMuchLinesChange) {
    const Disk disk(shapes::grid(3, 2));
    std::vector<Vec2> uv = laid_flat(disk);
    for (const double strain : face_strains(disk.problem, uv))
        EXPECT_NEAR(strain, 0.0, 1e-9);
    // Twice as wide in the plane: lines on the surface are half as long. Half as high: twice.
    for (Vec2& p : uv)
        p.x() *= 2.0;
    for (const double strain : face_strains(disk.problem, uv))
        EXPECT_NEAR(strain, 0.5, 1e-9);
    for (Vec2& p : uv)
        p.y() *= 0.5;
    for (const double strain : face_strains(disk.problem, uv))
        EXPECT_NEAR(strain, 1.0, 1e-9);
    std::swap(uv[disk.problem.faces[0][0]], uv[disk.problem.faces[0][1]]);
    EXPECT_EQ(face_strains(disk.problem, uv)[0], infinite);
}

TEST(Strain, IsSummedByArea) {
    const Strain strain = measure_strain({0.3, 0.1, 0.2}, {0.005, 0.9, 0.095});
    EXPECT_NEAR(strain.mean, 0.0015 + 0.09 + 0.019, 1e-12);
    EXPECT_DOUBLE_EQ(strain.most_of_it, 0.2);
    EXPECT_DOUBLE_EQ(strain.worst, 0.3);
}

std::vector<Vec2> sewn(const Disk& disk) {
    const auto map = least_strain_map(disk.problem, disk.surface,
                                      plane::layout_tolerance(disk.problem.model_size),
                                      SewingMapOptions{}, Progress{});
    EXPECT_TRUE(map.has_value());
    return map ? map->uv : std::vector<Vec2>();
}

Strain strain_of(const Disk& disk, const std::vector<Vec2>& uv) {
    return measure_strain(face_strains(disk.problem, uv), disk.problem.area);
}

TEST(LeastStrain, SeamsKeepTheirLengths) {
    for (const mesh::RawMesh& raw : {saddle(1.0), dome(0.4), shapes::cone(40, 16, 1.0, 2.0)}) {
        const Disk disk(raw);
        const std::vector<Vec2> uv = sewn(disk);
        ASSERT_EQ(count_flips(disk.problem, uv), 0);
        for (std::size_t i = 0; i < disk.problem.boundary.size(); ++i) {
            const std::size_t n = (i + 1) % disk.problem.boundary.size();
            EXPECT_NEAR((uv[disk.problem.boundary[n]] - uv[disk.problem.boundary[i]]).norm(),
                        disk.problem.boundary_edge[i], 1e-6 * disk.problem.boundary_edge[i]);
        }
    }
}

TEST(LeastStrain, DevelopablesAreNotStrained) {
    const Disk disk(shapes::cylinder_tube(32, 8));
    EXPECT_LT(strain_of(disk, sewn(disk)).worst, 1e-3);
}

// The worst faces count for most: neither the map of even areas nor the least symmetric Dirichlet
// energy inside the same boundary does as well.
TEST(LeastStrain, IsLessThanInOtherMaps) {
    for (const mesh::RawMesh& raw : {saddle(1.2), dome(0.5)}) {
        const Disk disk(raw);
        const std::vector<Vec2> uv = sewn(disk);
        const Strain least = strain_of(disk, uv);
        const auto even =
            sewing_map(disk.problem, disk.surface, plane::layout_tolerance(disk.problem.model_size),
                       SewingMapOptions{}, Progress{});
        ASSERT_TRUE(even.has_value());
        EXPECT_LT(least.worst, strain_of(disk, even->uv).worst);
        SymmetricDirichletOptions options;
        options.fixed.assign(uv.size(), 0);
        for (const Vertex v : disk.problem.boundary)
            options.fixed[v] = 1;
        const std::vector<Vec2> smooth =
            minimise_symmetric_dirichlet(disk.problem, uv, options, Progress{}).uv;
        EXPECT_LE(least.worst, strain_of(disk, smooth).worst);
    }
}

TEST(LeastStrain, HopelessMapsAreGivenUp) {
    const Disk disk(shapes::hemisphere(32, 12));
    SewingMapOptions options;
    const double tolerance = plane::layout_tolerance(disk.problem.model_size);
    EXPECT_TRUE(least_strain_map(disk.problem, disk.surface, tolerance, options, Progress{}));
    options.give_up_excess = 0.005;
    EXPECT_FALSE(least_strain_map(disk.problem, disk.surface, tolerance, options, Progress{}));
}

// A ring of a little more than a turn lies on itself where it is developed. Its sides keep their
// lengths, and cloth between them gives way.
TEST(LeastStrain, OverlappingPartsArePushedApart) {
    const Disk disk(shapes::helix_strip(120, 1.01, 20.0, 26.0, 0.5));
    const double tolerance = plane::layout_tolerance(disk.problem.model_size);
    SewingMapOptions options;
    options.push_apart = false;
    EXPECT_FALSE(least_strain_map(disk.problem, disk.surface, tolerance, options, Progress()));
    options.push_apart = true;
    const auto map = least_strain_map(disk.problem, disk.surface, tolerance, options, Progress());
    ASSERT_TRUE(map.has_value());
    EXPECT_TRUE(map->pushed);
    const std::vector<Vec2>& uv = map->uv;
    EXPECT_TRUE(overlapping_pairs(disk.surface, uv, tolerance).empty());
    EXPECT_EQ(count_flips(disk.problem, uv), 0);
    for (std::size_t i = 0; i < disk.problem.boundary.size(); ++i) {
        const Vertex v = disk.problem.boundary[i];
        const Vertex u = disk.problem.boundary[(i + 1) % disk.problem.boundary.size()];
        EXPECT_NEAR((uv[u] - uv[v]).norm(), disk.problem.boundary_edge[i], 1e-9);
    }
    EXPECT_LT(measure_strain(face_strains(disk.problem, uv), disk.problem.area).most_of_it, 0.1);
}

} // namespace
} // namespace devseg::flatten
