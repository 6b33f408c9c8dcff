#include "devseg/flatten/maps/arap.h"

#include <algorithm>
#include <cmath>

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

ArapResult minimise(const Disk& disk, const std::vector<Vec2>& start,
                    const ArapOptions& options = {}) {
    return minimise_arap(disk.problem, start, options, Progress{});
}

// Σ A ((σ₁ − 1)² + (±σ₂ − 1)²) / Σ A, from the singular values; σ₂ is negative on flipped faces.
double energy_from_stretches(const Disk& disk, const std::vector<Vec2>& uv) {
    double sum = 0.0;
    for (std::size_t f = 0; f < disk.problem.faces.size(); ++f) {
        const auto [s, t] = checks::stretches(disk.problem, uv, f);
        const double sign = checks::count_flips({disk.problem.faces[f]}, uv) == 0 ? 1.0 : -1.0;
        sum += disk.problem.area[f] * (std::pow(s - 1.0, 2) + std::pow(sign * t - 1.0, 2));
    }
    return sum / disk.problem.total_area;
}

std::vector<Disk> developables() {
    const auto ruling = [](const Vec3& p) { return std::abs(p.y()) < 1e-12 && p.x() > 0.0; };
    return {Disk(shapes::grid(5, 4)), Disk(shapes::cylinder_tube(24, 7)),
            Disk(shapes::cone(24, 7), ruling), Disk(shapes::folded_strip(20, 5, 0.2))};
}

std::vector<Disk> curved() {
    return {Disk(shapes::hemisphere(20, 8)), Disk(shapes::with_noise(shapes::grid(9, 9), 0.05, 3)),
            Disk(shapes::torus(14, 9)), Disk(shapes::plate_with_handle()), Disk(shapes::sphere(2))};
}

void expect_isometric(const Disk& disk, const std::vector<Vec2>& uv) {
    EXPECT_EQ(checks::count_flips(disk.problem.faces, uv), 0);
    for (std::size_t f = 0; f < disk.problem.faces.size(); ++f)
        for (const double s : checks::stretches(disk.problem, uv, f))
            EXPECT_NEAR(s, 1.0, 1e-6);
}

TEST(Arap, EnergyIsThatOfTheSingularValues) {
    Random random(17);
    for (const Disk& disk : curved()) {
        std::vector<Vec2> uv(at(disk.problem.vertex_count));
        for (Vec2& p : uv) // turns about half of the faces over
            p = Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        for (const std::vector<Vec2>& map : {uv, flatten_lscm(disk.problem)}) {
            const double expected = energy_from_stretches(disk, map);
            EXPECT_NEAR(arap_energy(disk.problem, map), expected, 1e-9 * expected);
        }
    }
}

TEST(Arap, DevelopablesAreFlattenedIsometrically) {
    for (const Disk& disk : developables()) {
        const ArapResult near = minimise(disk, flatten_lscm(disk.problem));
        EXPECT_TRUE(near.converged);
        expect_isometric(disk, near.uv);
        // From far away as well, only later.
        ArapOptions options;
        options.max_rounds = 20000;
        options.relative_tolerance = 1e-12;
        const ArapResult far = minimise(disk, flatten_tutte(disk.problem), options);
        EXPECT_LT(far.energy, 1e-12);
        expect_isometric(disk, far.uv);
    }
}

TEST(Arap, NoRoundRaisesTheEnergy) {
    ArapOptions one_round;
    one_round.max_rounds = 1;
    for (const Disk& disk : curved()) {
        std::vector<Vec2> uv = flatten_tutte(disk.problem);
        double before = energy_from_stretches(disk, uv);
        for (int round = 0; round < 40; ++round) {
            const ArapResult result = minimise(disk, uv, one_round);
            uv = result.uv;
            const double after = energy_from_stretches(disk, uv);
            EXPECT_LE(after, before * (1.0 + 1e-12));
            EXPECT_NEAR(result.energy, after, 1e-9 * after);
            before = after;
        }
        // The same rounds in one run.
        ArapOptions options;
        options.max_rounds = 40;
        options.relative_tolerance = 0.0;
        EXPECT_EQ(minimise(disk, flatten_tutte(disk.problem), options).uv, uv);
    }
}

TEST(Arap, ConvergedMapsAreStationary) {
    for (const Disk& disk : curved()) {
        ArapOptions options;
        options.max_rounds = 20000;
        options.relative_tolerance = 1e-12;
        const ArapResult result = minimise(disk, flatten_tutte(disk.problem), options);
        EXPECT_TRUE(result.converged);
        EXPECT_EQ(result.flips, checks::count_flips(disk.problem.faces, result.uv));
        std::vector<Vec2> uv = result.uv;
        double largest = 0.0;
        for (std::size_t v = 0; v < uv.size(); ++v)
            for (int c = 0; c < 2; ++c) {
                const double home = uv[v][c];
                constexpr double h = 1e-5;
                uv[v][c] = home + h;
                const double more = arap_energy(disk.problem, uv);
                uv[v][c] = home - h;
                const double less = arap_energy(disk.problem, uv);
                uv[v][c] = home;
                largest = std::max(largest, std::abs(more - less) / (2.0 * h));
            }
        EXPECT_LT(largest, 1e-5);
    }
}

TEST(Arap, KeepsLengthsBetterThanItsStart) {
    for (const Disk& disk :
         {Disk(shapes::hemisphere(24, 12)), Disk(shapes::finger(12, 8, 1.0, 3.0))}) {
        const std::vector<Vec2> start = flatten_lscm(disk.problem);
        const ArapResult result = minimise(disk, start);
        EXPECT_TRUE(result.converged);
        EXPECT_EQ(result.flips, 0);
        EXPECT_LT(checks::l2_stretch(disk.problem, result.uv),
                  checks::l2_stretch(disk.problem, start));
    }
}

TEST(Arap, ThinTrianglesGiveFiniteMapsOrFailures) {
    for (const double width : {1e-2, 1e-4, 1e-6, 0.0})
        for (const std::uint32_t seed : {1u, 2u}) {
            // Columns of needles, with vertices that lie almost on the opposite edges.
            mesh::RawMesh raw = shapes::with_noise(shapes::grid(6, 40), 1e-3, seed);
            for (Vec3& p : raw.points)
                p.x() *= width;
            const Disk disk(raw);
            try {
                for (const Vec2& p : minimise(disk, flatten_tutte(disk.problem)).uv)
                    EXPECT_TRUE(p.allFinite());
            } catch (const NumericalFailure&) {
                continue; // said, not hidden
            }
        }
}

TEST(Arap, RunsAreEqualAndCanBeCancelled) {
    const Disk disk(shapes::torus(14, 9));
    const std::vector<Vec2> start = flatten_tutte(disk.problem);
    EXPECT_EQ(minimise(disk, start).uv, minimise(disk, start).uv);
    Progress stopped([](double, const char*) { return false; });
    EXPECT_THROW(stopped.update(0.0), Cancelled);
    EXPECT_THROW(minimise_arap(disk.problem, start, ArapOptions{}, stopped), Cancelled);
}

// Half of the faces a little askew: the parts of a join, laid out apart.
TEST(Stitch, FitsPartsTogetherThatAreIsometricTogether) {
    for (const Disk& disk : developables()) {
        const ArapResult map = minimise(disk, flatten_lscm(disk.problem));
        std::vector<Vec2> turns = face_turns(disk.problem, map.uv);
        for (std::size_t f = turns.size() / 2; f < turns.size(); ++f)
            turns[f] = Eigen::Rotation2Dd(0.05) * turns[f];
        const Laplacian laplacian(disk.problem);
        StitchOptions options;
        const std::vector<Vec2> once = stitch(disk.problem, laplacian, turns, options);
        options.rounds = 20;
        const std::vector<Vec2> often = stitch(disk.problem, laplacian, turns, options);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, often), 0);
        EXPECT_LT(arap_energy(disk.problem, often), 0.5 * arap_energy(disk.problem, once));
        EXPECT_LT(arap_energy(disk.problem, often), 1e-4);
    }
}

TEST(Stitch, GivesUpWhereTheEnergyIsHopeless) {
    const Disk disk(shapes::hemisphere(20, 8));
    const ArapResult map = minimise(disk, flatten_lscm(disk.problem));
    const std::vector<Vec2> turns = face_turns(disk.problem, map.uv);
    const Laplacian laplacian(disk.problem);
    StitchOptions options;
    options.give_up_energy = 2.0 * map.energy;
    EXPECT_FALSE(stitch(disk.problem, laplacian, turns, options).empty());
    options.give_up_energy = 0.5 * map.energy;
    EXPECT_TRUE(stitch(disk.problem, laplacian, turns, options).empty());
}

} // namespace
} // namespace devseg::flatten
