#include "devseg/flatten/maps/lscm.h"

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
using shapes::Random;

// A cone is flat once it is cut from its rim to its apex.
Disk open_cone(Index around, Index along, double radius, double height) {
    return Disk(shapes::cone(around, along, radius, height), [](const Vec3& middle) {
        return std::abs(middle.y()) < 1e-12 && middle.x() > 0.0;
    });
}

std::vector<Disk> developables() {
    return {Disk(shapes::grid(7, 5, 2.0, 1.0)),
            Disk(shapes::cylinder_tube(24, 6)),
            Disk(shapes::cylinder_tube(40, 3, 1.0, 12.0)),
            Disk(shapes::cylinder_tube(3, 2)),
            Disk(shapes::frustum(30, 6, 1.0, 0.2, 1.5)),
            open_cone(30, 8, 1.0, 2.0),
            open_cone(12, 5, 1.0, 0.3)};
}

std::vector<Disk> curved() {
    return {Disk(shapes::hemisphere(20, 8)), Disk(shapes::with_noise(shapes::grid(8, 8), 0.05, 3)),
            Disk(shapes::torus(14, 9)), Disk(shapes::plate_with_handle()), Disk(shapes::sphere(2))};
}

double shoelace(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double twice = 0.0;
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        const Vec2& p = uv[problem.boundary[i]];
        const Vec2& q = uv[problem.boundary[(i + 1) % problem.boundary.size()]];
        twice += p.x() * q.y() - p.y() * q.x();
    }
    return 0.5 * twice;
}

// Dirichlet energy minus area, from the positions in space: ¼ Σ cot |Δuv|² − ½ Σ u × v.
double energy_from_cotangents(const Disk& disk, const std::vector<Vec2>& uv) {
    double dirichlet = 0.0;
    for (std::size_t f = 0; f < disk.problem.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Triangle& t = disk.mesh.faces[disk.surface.face[f]];
            const Vec3& tip = disk.mesh.points[t[(k + 2) % 3]];
            const Vec3 a = disk.mesh.points[t[k]] - tip;
            const Vec3 b = disk.mesh.points[t[(k + 1) % 3]] - tip;
            const Triangle& local = disk.problem.faces[f];
            dirichlet += 0.25 * a.dot(b) / a.cross(b).norm() *
                         (uv[local[k]] - uv[local[(k + 1) % 3]]).squaredNorm();
        }
    return dirichlet - shoelace(disk.problem, uv);
}

TEST(Lscm, DevelopablesAreFlattenedIsometrically) {
    for (const Disk& disk : developables()) {
        const std::vector<Vec2> uv = flatten_lscm(disk.problem);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, uv), 0);
        EXPECT_NEAR(checks::l2_stretch(disk.problem, uv), 1.0, 1e-6);
        for (std::size_t f = 0; f < disk.problem.faces.size(); ++f)
            for (const double s : checks::stretches(disk.problem, uv, f))
                EXPECT_NEAR(s, 1.0, 1e-6);
        EXPECT_NEAR(conformal_energy(disk.problem, uv), 0.0, 1e-10);
    }
}

TEST(Lscm, OneTriangleKeepsItsShape) {
    const Disk disk(mesh::RawMesh{{{0, 0, 0}, {5, 1, 2}, {1, 3, -1}}, {{0, 1, 2}}});
    const std::vector<Vec2> uv = flatten_lscm(disk.problem);
    for (const double s : checks::stretches(disk.problem, uv, 0))
        EXPECT_NEAR(s, 1.0, 1e-12);
}

TEST(Lscm, EnergyAgreesWithItsCotangentForm) {
    Random random(41);
    for (const Disk& disk : curved()) {
        std::vector<Vec2> uv;
        for (Index v = 0; v < disk.problem.vertex_count; ++v)
            uv.emplace_back(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        const double energy = conformal_energy(disk.problem, uv);
        EXPECT_NEAR(energy, energy_from_cotangents(disk, uv), 1e-10 * energy);
        const std::vector<Vec2> flat = flatten_lscm(disk.problem);
        EXPECT_NEAR(conformal_energy(disk.problem, flat), energy_from_cotangents(disk, flat),
                    1e-10 * disk.problem.total_area);
    }
}

TEST(Lscm, EnergyIsZeroForSimilaritiesOnly) {
    const Disk disk(shapes::grid(3, 3));
    const auto energy_of_map = [&](double a, double b, double c, double d) {
        std::vector<Vec2> uv;
        for (const Index v : disk.surface.vertex) {
            const Vec3& p = disk.mesh.points[v];
            uv.emplace_back(a * p.x() + b * p.y(), c * p.x() + d * p.y());
        }
        return conformal_energy(disk.problem, uv) / disk.problem.total_area;
    };
    EXPECT_NEAR(energy_of_map(2.0, -1.0, 1.0, 2.0), 0.0, 1e-14);
    EXPECT_NEAR(energy_of_map(3.0, 0.0, 0.0, 1.0), 0.5 * 4.0, 1e-13);  // ½ (3 − 1)²
    EXPECT_NEAR(energy_of_map(-1.0, 0.0, 0.0, 1.0), 0.5 * 4.0, 1e-13); // ½ (1 + 1)²
}

TEST(Lscm, NoVertexButThePinsWouldRatherBeElsewhere) {
    for (const Disk& disk : curved()) {
        std::vector<Vec2> uv = flatten_lscm(disk.problem);
        Index pulled = 0;
        for (Index v = 0; v < disk.problem.vertex_count; ++v) {
            Vec2 gradient;
            for (int c = 0; c < 2; ++c) { // exact for a quadratic energy
                const double home = uv[v][c];
                constexpr double h = 1e-2;
                uv[v][c] = home + h;
                const double more = conformal_energy(disk.problem, uv);
                uv[v][c] = home - h;
                const double less = conformal_energy(disk.problem, uv);
                uv[v][c] = home;
                gradient[c] = (more - less) / (2.0 * h);
            }
            pulled += gradient.norm() > 1e-9 ? 1 : 0;
        }
        EXPECT_LE(pulled, 2);
    }
}

TEST(Lscm, MapsArePositivelyOrientedWithTheChartsArea) {
    for (const std::vector<Disk>& group : {developables(), curved()})
        for (const Disk& disk : group) {
            const std::vector<Vec2> uv = flatten_lscm(disk.problem);
            EXPECT_NEAR(shoelace(disk.problem, uv), disk.problem.total_area, 1e-9);
            EXPECT_NEAR(map_area(disk.problem, uv), disk.problem.total_area, 1e-9);
        }
    // Seen from the other side, the map is the mirror image: still positive.
    const Disk inside(shapes::turned_over(shapes::hemisphere(16, 6)));
    EXPECT_GT(shoelace(inside.problem, flatten_lscm(inside.problem)), 0.0);
}

TEST(Lscm, AnglesArePreservedOnAHemisphere) {
    // The smooth map is conformal: the finer the mesh, the nearer.
    double before = 1.0;
    for (const Index n : {6, 12, 24}) {
        const Disk disk(shapes::hemisphere(4 * n, n));
        const std::vector<Vec2> uv = flatten_lscm(disk.problem);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, uv), 0);
        const double energy = conformal_energy(disk.problem, uv) / disk.problem.total_area;
        EXPECT_LT(energy, 0.5 * before);
        before = energy;
    }
    EXPECT_LT(before, 2e-3);
}

TEST(Lscm, RotationOfTheSurfaceDoesNotMatter) {
    const mesh::RawMesh raw = shapes::with_noise(shapes::hemisphere(14, 6), 0.02, 8);
    mesh::RawMesh turned = raw;
    const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
    for (Vec3& p : turned.points)
        p = turn * p;
    const Disk a(raw);
    const Disk b(turned);
    const std::vector<Vec2> uv_a = flatten_lscm(a.problem);
    const std::vector<Vec2> uv_b = flatten_lscm(b.problem);
    const double scale = b.mesh.unit_length / a.mesh.unit_length;
    for (std::size_t v = 0; v < uv_a.size(); ++v)
        EXPECT_LT((uv_a[v] - scale * uv_b[v]).norm(), 1e-9);
}

} // namespace
} // namespace devseg::flatten
