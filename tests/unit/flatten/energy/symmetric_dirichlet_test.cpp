#include "devseg/flatten/energy/symmetric_dirichlet.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/maps/tutte.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;
using shapes::Random;

SymmetricDirichletResult minimise(const Disk& disk, const std::vector<Vec2>& start,
                                  const SymmetricDirichletOptions& options = {}) {
    const Progress progress;
    return minimise_symmetric_dirichlet(disk.problem, start, options, progress);
}

// Σ A (σ₁² + σ₂² + σ₁⁻² + σ₂⁻²) / (4 Σ A), from the singular values.
double energy_from_stretches(const Disk& disk, const std::vector<Vec2>& uv) {
    double sum = 0.0;
    for (std::size_t f = 0; f < disk.problem.faces.size(); ++f) {
        const auto [s, t] = checks::stretches(disk.problem, uv, f);
        sum += disk.problem.area[f] * 0.25 * (s * s + t * t + 1.0 / (s * s) + 1.0 / (t * t));
    }
    return sum / disk.problem.total_area;
}

std::vector<mesh::RawMesh> curved() {
    return {shapes::hemisphere(16, 7), shapes::with_noise(shapes::grid(9, 9), 0.04, 3),
            shapes::torus(14, 9),      shapes::plate_with_handle(),
            shapes::sphere(2),         shapes::finger(10, 12, 1.0, 6.0)};
}

std::vector<Vec2> identity(const Disk& disk) {
    std::vector<Vec2> uv;
    for (const Index v : disk.surface.vertex)
        uv.push_back(disk.mesh.points[v].head<2>());
    return uv;
}

TEST(SymmetricDirichlet, EnergyIsThatOfTheSingularValues) {
    for (const mesh::RawMesh& raw : curved()) {
        const Disk disk(raw);
        const std::vector<Vec2> uv = flatten_tutte(disk.problem);
        const double expected = energy_from_stretches(disk, uv);
        EXPECT_NEAR(symmetric_dirichlet_energy(disk.problem, uv), expected, 1e-6 * expected);
    }
    const Disk disk(shapes::grid(4, 4));
    std::vector<Vec2> uv = identity(disk);
    EXPECT_NEAR(symmetric_dirichlet_energy(disk.problem, uv), 1.0, 1e-12);
    for (Vec2& p : uv)
        p = Vec2(2.0 * p.x(), 0.5 * p.y());
    EXPECT_NEAR(symmetric_dirichlet_energy(disk.problem, uv), 0.5 * (4.0 + 0.25), 1e-12);
}

TEST(SymmetricDirichlet, EnergyIsInfiniteForFlipsAndFacesWithoutArea) {
    const Disk disk(shapes::grid(4, 4));
    std::vector<Vec2> uv = identity(disk);
    for (Vec2& p : uv)
        p.x() = -p.x();
    EXPECT_EQ(symmetric_dirichlet_energy(disk.problem, uv),
              std::numeric_limits<double>::infinity());
    for (Vec2& p : uv)
        p.x() = 0.0;
    EXPECT_EQ(symmetric_dirichlet_energy(disk.problem, uv),
              std::numeric_limits<double>::infinity());
}

TEST(SymmetricDirichlet, DevelopablesBecomeIsometricFromAnyStart) {
    for (const mesh::RawMesh& raw :
         {shapes::grid(8, 5), shapes::cylinder_tube(20, 6), shapes::frustum(24, 6, 1.0, 0.3, 2.0),
          shapes::cylinder_tube(30, 4, 1.0, 0.5), shapes::annulus(24, 3, 1.0, 1.5)}) {
        const Disk disk(raw);
        for (const std::vector<Vec2>& start :
             {flatten_tutte(disk.problem), flatten_lscm(disk.problem)}) {
            const SymmetricDirichletResult result = minimise(disk, start);
            EXPECT_TRUE(result.converged);
            EXPECT_NEAR(result.energy, 1.0, 1e-6);
        }
        EXPECT_NEAR(minimise(disk, flatten_lscm(disk.problem)).energy, 1.0, 1e-9);
    }
}

TEST(SymmetricDirichlet, ATightToleranceReachesTheIsometry) {
    const Disk disk(shapes::cylinder_tube(16, 4));
    SymmetricDirichletOptions options;
    options.relative_tolerance = 1e-14;
    options.max_iterations = 2000;
    EXPECT_NEAR(minimise(disk, flatten_tutte(disk.problem), options).energy, 1.0, 1e-9);
}

TEST(SymmetricDirichlet, EveryStepGoesDownAndFlipsNothing) {
    for (const mesh::RawMesh& raw : curved()) {
        const Disk disk(raw);
        const std::vector<Vec2> start = flatten_tutte(disk.problem);
        double before = symmetric_dirichlet_energy(disk.problem, start);
        for (int steps = 0; steps <= 30; ++steps) {
            SymmetricDirichletOptions options;
            options.max_iterations = steps;
            const SymmetricDirichletResult result = minimise(disk, start, options);
            ASSERT_LE(result.iterations, steps);
            ASSERT_EQ(checks::count_flips(disk.problem.faces, result.uv), 0);
            ASSERT_LE(result.energy, before);
            ASSERT_NEAR(result.energy, energy_from_stretches(disk, result.uv), 1e-6 * before);
            if (steps == 0) {
                ASSERT_EQ(result.energy, before);
            }
            before = result.energy;
        }
    }
}

TEST(SymmetricDirichlet, ResultsAreNearlyStationary) {
    // Neither moves of single vertices nor smooth fields lower the energy by more than the
    // tolerance of the stopping rule.
    for (const mesh::RawMesh& raw : curved()) {
        const Disk disk(raw);
        const SymmetricDirichletResult result = minimise(disk, flatten_tutte(disk.problem));
        EXPECT_TRUE(result.converged);
        std::vector<Vec2> uv = result.uv;
        const double size = std::sqrt(disk.problem.total_area);
        double gained = 0.0;
        Random random(7);
        for (int run = 0; run < 300; ++run) {
            const std::size_t v = at(random.below(disk.problem.vertex_count));
            const Vec2 home = uv[v];
            const Vec3 d = random.direction();
            uv[v] += std::pow(10.0, random.uniform(-5.0, -2.0)) * size * d.head<2>();
            gained = std::max(gained, result.energy - symmetric_dirichlet_energy(disk.problem, uv));
            uv[v] = home;
        }
        for (int run = 0; run < 300; ++run) {
            const Vec3 a = random.direction();
            const Vec3 b = random.direction();
            const double amplitude = std::pow(10.0, random.uniform(-5.0, -2.0)) * size;
            std::vector<Vec2> moved = uv;
            for (Vec2& p : moved) {
                const Vec2 q = p / size;
                p += amplitude *
                     Vec2(a.x() * q.x() + a.y() * q.y() + a.z() * q.x() * q.y(),
                          b.x() * q.y() + b.y() * q.x() + b.z() * (q.x() * q.x() - q.y() * q.y()));
            }
            gained =
                std::max(gained, result.energy - symmetric_dirichlet_energy(disk.problem, moved));
        }
        EXPECT_LT(gained, 1e-5 * result.energy);
    }
}

TEST(SymmetricDirichlet, StartsThatAreTurnedOrMovedGiveTheSameMap) {
    const Disk disk(shapes::hemisphere(14, 6));
    const std::vector<Vec2> start = flatten_lscm(disk.problem);
    std::vector<Vec2> turned = start;
    const Eigen::Rotation2Dd turn(2.0);
    for (Vec2& p : turned)
        p = turn * p + Vec2(5.0, -3.0);
    SymmetricDirichletOptions options;
    options.relative_tolerance = 1e-12;
    options.max_iterations = 1000;
    const SymmetricDirichletResult a = minimise(disk, start, options);
    const SymmetricDirichletResult b = minimise(disk, turned, options);
    EXPECT_NEAR(a.energy, b.energy, 1e-9);
    // The same shape: all distances agree.
    for (std::size_t v = 0; v < a.uv.size(); v += 3)
        for (std::size_t w = 0; w < v; w += 5)
            EXPECT_NEAR((a.uv[v] - a.uv[w]).norm(), (b.uv[v] - b.uv[w]).norm(), 1e-4);
}

TEST(SymmetricDirichlet, TheStartMatterslittleForTheEnergy) {
    for (const mesh::RawMesh& raw : {shapes::hemisphere(16, 7), shapes::torus(14, 9)}) {
        const Disk disk(raw);
        const std::vector<Vec2> lscm = flatten_lscm(disk.problem);
        ASSERT_EQ(checks::count_flips(disk.problem.faces, lscm), 0);
        const double from_lscm = minimise(disk, lscm).energy;
        const double from_tutte = minimise(disk, flatten_tutte(disk.problem)).energy;
        EXPECT_NEAR(from_lscm, from_tutte, 1e-3 * from_lscm);
        EXPECT_LT(from_lscm, symmetric_dirichlet_energy(disk.problem, lscm));
    }
}

TEST(SymmetricDirichlet, TheOptimalScaleOfAMapIsFound) {
    // Along u → s u the energy s² a + b / s² is least where both terms are equal.
    const Disk disk(shapes::hemisphere(14, 6));
    const std::vector<Vec2> uv = minimise(disk, flatten_lscm(disk.problem)).uv;
    const auto scaled = [&](double s) {
        std::vector<Vec2> result = uv;
        for (Vec2& p : result)
            p *= s;
        return symmetric_dirichlet_energy(disk.problem, result);
    };
    EXPECT_LT(scaled(1.0), scaled(1.01));
    EXPECT_LT(scaled(1.0), scaled(0.99));
}

TEST(SymmetricDirichlet, RefusesAStartWithFlips) {
    const Disk disk(shapes::grid(4, 4));
    std::vector<Vec2> uv = identity(disk);
    uv.at(0) = uv.at(12);
    EXPECT_TRUE(checks::contains(checks::error_of<NumericalFailure>([&] { minimise(disk, uv); }),
                                 "without flipped faces"));
}

TEST(SymmetricDirichlet, Cancels) {
    const Disk disk(shapes::sphere(3));
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW(progress.update(0.0), Cancelled);
    EXPECT_THROW(
        minimise_symmetric_dirichlet(disk.problem, flatten_tutte(disk.problem), {}, progress),
        Cancelled);
}

} // namespace
} // namespace devseg::flatten
