#include "devseg/flatten/energy/distortion.h"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "devseg/flatten/maps/tutte.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;
using shapes::Random;

Positions positions(const std::vector<Vec2>& uv) {
    Positions x(static_cast<Eigen::Index>(uv.size()), 2);
    for (std::size_t v = 0; v < uv.size(); ++v)
        x.row(static_cast<Eigen::Index>(v)) = uv[v].transpose();
    return x;
}

// ψ = (|J|² + |J⁻¹|²) / 4.
double density(const Eigen::Matrix2d& j) {
    return 0.25 * (j.squaredNorm() + j.inverse().squaredNorm());
}

Eigen::Matrix4d hessian_by_differences(const Eigen::Matrix2d& j) {
    constexpr double h = 1e-4;
    Eigen::Matrix4d hessian;
    const auto moved = [&](int a, double da, int b, double db) {
        Eigen::Matrix2d k = j;
        k.data()[a] += da; // column by column
        k.data()[b] += db;
        return density(k);
    };
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
            hessian(a, b) = (moved(a, h, b, h) - moved(a, h, b, -h) - moved(a, -h, b, h) +
                             moved(a, -h, b, -h)) /
                            (4.0 * h * h);
    return hessian;
}

TEST(Distortion, TheGradientIsThatOfTheEnergy) {
    for (const mesh::RawMesh& raw :
         {shapes::hemisphere(10, 4), shapes::torus(9, 6), shapes::sphere(1)}) {
        const Disk disk(raw);
        Positions x = positions(flatten_tutte(disk.problem));
        const Positions gradient = distortion_gradient(disk.problem, x);
        Positions with_energy;
        EXPECT_EQ(distortion_with_gradient(disk.problem, x, with_energy),
                  distortion(disk.problem, x));
        EXPECT_EQ(with_energy, gradient);
        EXPECT_EQ(distortion_with_gradient(disk.problem, -x.rowwise().reverse(), with_energy),
                  infinite); // flipped
        const double scale = gradient.cwiseAbs().maxCoeff();
        for (Eigen::Index v = 0; v < x.rows(); ++v)
            for (Eigen::Index c = 0; c < 2; ++c) {
                constexpr double h = 1e-6;
                const double home = x(v, c);
                x(v, c) = home + h;
                const double more = distortion(disk.problem, x);
                x(v, c) = home - h;
                const double less = distortion(disk.problem, x);
                x(v, c) = home;
                ASSERT_NEAR(gradient(v, c), (more - less) / (2.0 * h), 1e-5 * scale);
            }
        EXPECT_LT(gradient.colwise().sum().norm(), 1e-9 * scale); // moving all changes nothing
    }
}

TEST(Distortion, HessiansAreProjectedAndElseExact) {
    Random random(51);
    int projected = 0;
    for (int run = 0; run < 300; ++run) {
        Eigen::Matrix2d j;
        do
            j << random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0),
                random.uniform(-2.0, 2.0);
        while (j.determinant() < 0.2);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> exact(hessian_by_differences(j));
        // The same eigenvectors, with negative eigenvalues set to zero.
        const Eigen::Matrix4d expected = exact.eigenvectors() *
                                         exact.eigenvalues().cwiseMax(0.0).asDiagonal() *
                                         exact.eigenvectors().transpose();
        projected += exact.eigenvalues().minCoeff() < -1e-3 ? 1 : 0;
        const Eigen::Matrix4d found = projected_hessian(j);
        ASSERT_LT((found - expected).norm(), 1e-4 * (1.0 + expected.norm())) << j;
    }
    EXPECT_GT(projected, 20);
    EXPECT_LT(projected, 280);
}

TEST(Distortion, TheCollapseStepIsWhereTheFirstTriangleHasNoArea) {
    const Disk disk(shapes::with_noise(shapes::grid(5, 5), 0.03, 2));
    std::vector<Vec2> uv;
    for (const Index v : disk.surface.vertex)
        uv.push_back(disk.mesh.points[v].head<2>());
    const Positions x = positions(uv);
    const auto least_area = [&](const Positions& y) {
        double least = std::numeric_limits<double>::infinity();
        for (const Triangle& t : disk.problem.faces) {
            const Eigen::RowVector2d p = y.row(t[1]) - y.row(t[0]);
            const Eigen::RowVector2d q = y.row(t[2]) - y.row(t[0]);
            least = std::min(least, p.x() * q.y() - p.y() * q.x());
        }
        return least;
    };
    Random random(52);
    for (int run = 0; run < 100; ++run) {
        Positions d(x.rows(), 2);
        for (Eigen::Index v = 0; v < d.rows(); ++v)
            d.row(v) = random.direction().head<2>().transpose();
        const double step = collapse_step(disk.problem, x, d);
        ASSERT_TRUE(step > 0.0 && std::isfinite(step));
        EXPECT_NEAR(least_area(x + step * d), 0.0, 1e-12);
        for (const double limit : {0.3 * step, 0.99 * step})
            EXPECT_GT(collapse_step(disk.problem, x, d, limit), limit);
        EXPECT_EQ(collapse_step(disk.problem, x, d, 1.01 * step), step);
        for (int i = 0; i < 50; ++i)
            EXPECT_GT(least_area(x + 0.02 * i * step * d), 0.0);
    }
    const Positions same = Positions::Ones(x.rows(), 2); // all vertices move together
    EXPECT_EQ(collapse_step(disk.problem, x, same), std::numeric_limits<double>::infinity());
    EXPECT_EQ(collapse_step(disk.problem, x, x), std::numeric_limits<double>::infinity()); // growth
    EXPECT_NEAR(collapse_step(disk.problem, x, -x), 1.0, 1e-12); // down to a point
}

} // namespace
} // namespace devseg::flatten
