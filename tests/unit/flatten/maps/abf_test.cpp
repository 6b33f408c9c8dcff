#include "devseg/flatten/maps/abf.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lscm.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;

mesh::RawMesh bumpy_grid(Index cells) {
    mesh::RawMesh mesh = shapes::grid(cells, cells, cells, cells);
    for (Vec3& p : mesh.points)
        p.z() = 0.35 * std::sin(0.8 * p.x()) * std::cos(0.7 * p.y());
    return shapes::with_noise(std::move(mesh), 0.15, 7);
}

// Root mean square change of the angles, weighted by area.
double shear(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t c = 0; c < 3; ++c) {
            const Triangle& t = problem.faces[f];
            const Vec2 p = uv[t[(c + 1) % 3]] - uv[t[c]];
            const Vec2 q = uv[t[(c + 2) % 3]] - uv[t[c]];
            const double angle = std::atan2(p.x() * q.y() - p.y() * q.x(), p.dot(q));
            const double change = angle - std::atan2(1.0, problem.cotangent[f][(c + 1) % 3]);
            sum += problem.area[f] * change * change / 3.0;
        }
    return std::sqrt(sum / problem.total_area);
}

// The gradients of the constraints, in the order of AngleSystem::constraints, written down from
// their definition.
Eigen::MatrixXd constraint_gradients(const FlatteningProblem& problem,
                                     const Eigen::VectorXd& angles) {
    std::vector<Index> inner(at(problem.vertex_count), 0);
    for (const Index v : problem.boundary)
        inner[v] = -1;
    Index count = 0;
    for (Index& number : inner)
        if (number >= 0)
            number = count++;
    const auto faces = static_cast<Eigen::Index>(problem.faces.size());
    Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(faces + count + count, 3 * faces);
    for (Eigen::Index f = 0; f < faces; ++f)
        for (Eigen::Index c = 0; c < 3; ++c) {
            const Eigen::Index next = 3 * f + (c + 1) % 3;
            const Eigen::Index previous = 3 * f + (c + 2) % 3;
            gradients(f, 3 * f + c) = 1.0;
            const Index v =
                inner[problem.faces[static_cast<std::size_t>(f)][static_cast<std::size_t>(c)]];
            if (v < 0)
                continue;
            gradients(faces + v, 3 * f + c) = 1.0;
            gradients(faces + count + v, next) += std::cos(angles[next]) / std::sin(angles[next]);
            gradients(faces + count + v, previous) -=
                std::cos(angles[previous]) / std::sin(angles[previous]);
        }
    return gradients;
}

TEST(Abf, ConstraintGradientsAreTheirDifferences) {
    const FlatteningProblem problem = Disk(bumpy_grid(4)).problem;
    const AngleSystem system(problem, AbfOptions{});
    const Eigen::VectorXd angles = system.start();
    const Eigen::MatrixXd gradients = constraint_gradients(problem, angles);
    constexpr double step = 1e-6;
    for (Eigen::Index i = 0; i < angles.size(); ++i) {
        const Eigen::VectorXd shift = step * Eigen::VectorXd::Unit(angles.size(), i);
        const Eigen::VectorXd difference =
            (system.constraints(angles + shift) - system.constraints(angles - shift)) /
            (2.0 * step);
        EXPECT_LT((difference - gradients.col(i)).lpNorm<Eigen::Infinity>(), 1e-7);
    }
}

TEST(Abf, ReducedSystemIsTheFullOne) {
    const FlatteningProblem problem = Disk(bumpy_grid(6)).problem;
    AngleSystem system(problem, AbfOptions{});
    Eigen::VectorXd angles = system.start();
    for (int round = 0; round < 3; ++round) {
        const Eigen::MatrixXd j = constraint_gradients(problem, angles);
        const Eigen::Index n = j.cols();
        const Eigen::Index m = j.rows();
        const Eigen::VectorXd weight = system.targets().array().square().inverse();
        Eigen::MatrixXd full = Eigen::MatrixXd::Zero(n + m, n + m);
        full.topLeftCorner(n, n) = (2.0 * weight).asDiagonal();
        full.topRightCorner(n, m) = j.transpose();
        full.bottomLeftCorner(m, n) = j;
        Eigen::VectorXd rhs(n + m);
        rhs << 2.0 * weight.cwiseProduct(system.targets() - angles), -system.constraints(angles);
        const Eigen::VectorXd expected = full.partialPivLu().solve(rhs);
        const AngleSystem::Step step = system.newton_step(angles);
        EXPECT_LT((step.angles - expected.head(n)).lpNorm<Eigen::Infinity>(), 1e-12);
        EXPECT_LT((step.multipliers - expected.tail(m)).lpNorm<Eigen::Infinity>(), 1e-12);
        angles += step.angles;
    }
    EXPECT_LT(system.constraints(angles).lpNorm<Eigen::Infinity>(), 1e-6);
}

AbfResult flatten(const Disk& disk) {
    return flatten_abf(disk.problem, AbfOptions{}, Progress{});
}

TEST(Abf, DevelopablesAreFlattenedIsometrically) {
    const auto ruling = [](const Vec3& p) { return std::abs(p.y()) < 1e-12 && p.x() > 0.0; };
    for (const Disk& disk :
         {Disk(shapes::grid(5, 4)), Disk(shapes::cylinder_tube(24, 7)),
          Disk(shapes::cone(24, 7), ruling), Disk(shapes::folded_strip(20, 5, 0.2))}) {
        const AbfResult result = flatten(disk);
        EXPECT_TRUE(result.converged);
        EXPECT_LT(result.energy, 1e-18);
        EXPECT_EQ(result.flips, 0);
        for (std::size_t f = 0; f < disk.problem.faces.size(); ++f)
            for (const double s : checks::stretches(disk.problem, result.uv, f))
                EXPECT_NEAR(s, 1.0, 1e-6);
    }
}

TEST(Abf, KeepsAnglesAsWellAsLeastSquaresConformalMaps) {
    for (const Disk& disk : {Disk(shapes::hemisphere(24, 12)), Disk(shapes::hemisphere(40, 30)),
                             Disk(bumpy_grid(12))}) {
        const AbfResult result = flatten(disk);
        EXPECT_TRUE(result.converged);
        EXPECT_LT(result.residual, 1e-8);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, result.uv), 0);
        EXPECT_LE(shear(disk.problem, result.uv), shear(disk.problem, flatten_lscm(disk.problem)));
        EXPECT_NEAR(map_area(disk.problem, result.uv), disk.problem.total_area, 1e-9);
    }
}

TEST(Abf, DoesNotFlipWhereLeastSquaresConformalMapsDo) {
    for (const std::uint32_t seed : {3u, 4u}) {
        const Disk disk(shapes::with_noise(shapes::grid(10, 10), 0.1, seed));
        EXPECT_GT(checks::count_flips(disk.problem.faces, flatten_lscm(disk.problem)), 0);
        const AbfResult result = flatten(disk);
        EXPECT_TRUE(result.converged);
        EXPECT_EQ(result.flips, 0);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, result.uv), 0);
    }
}

TEST(Abf, SaysWhenItDidNotConverge) {
    const Disk disk(shapes::hemisphere(24, 12));
    AbfOptions options;
    options.max_iterations = 1;
    const AbfResult result = flatten_abf(disk.problem, options, Progress{});
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.iterations, 1);
    EXPECT_GT(result.residual, 1e-8);
}

TEST(Abf, ThinTrianglesGiveFiniteMapsOrFailures) {
    for (const double width : {1e-2, 1e-4, 1e-6, 0.0})
        for (const std::uint32_t seed : {1u, 2u}) {
            // Columns of needles, with vertices that lie almost on the opposite edges.
            mesh::RawMesh raw = shapes::with_noise(shapes::grid(6, 40), 1e-3, seed);
            for (Vec3& p : raw.points)
                p.x() *= width;
            const Disk disk(raw);
            try {
                for (const Vec2& p : flatten(disk).uv)
                    EXPECT_TRUE(p.allFinite());
            } catch (const NumericalFailure&) {
                continue; // said, not hidden
            }
        }
}

TEST(Abf, OneTriangleKeepsItsShape) {
    const Disk disk(mesh::RawMesh{{{0, 0, 0}, {5, 1, 2}, {1, 3, -1}}, {{0, 1, 2}}});
    const AbfResult result = flatten(disk);
    EXPECT_TRUE(result.converged);
    for (const double s : checks::stretches(disk.problem, result.uv, 0))
        EXPECT_NEAR(s, 1.0, 1e-12);
}

TEST(Abf, RunsAreEqualAndCanBeCancelled) {
    const Disk disk(bumpy_grid(8));
    EXPECT_EQ(flatten(disk).uv, flatten(disk).uv);
    Progress stopped([](double, const char*) { return false; });
    EXPECT_THROW(stopped.update(0.0), Cancelled);
    EXPECT_THROW(flatten_abf(disk.problem, AbfOptions{}, stopped), Cancelled);
}

} // namespace
} // namespace devseg::flatten
