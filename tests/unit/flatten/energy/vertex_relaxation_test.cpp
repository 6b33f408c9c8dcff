#include "devseg/flatten/energy/vertex_relaxation.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using shapes::pi;
using shapes::Random;

// A star with the edges of its rest triangles kept, so that the energy can be found in another way.
struct Sample {
    VertexStar star;
    std::vector<Eigen::Matrix2d> rest; // columns: apex → from, apex → to

    // Σ A ψ or Σ A exp(s (ψ − 1)), ψ = (|J|² + |J⁻¹|²) / 4, from the Jacobians themselves.
    double energy(const Vec2& p) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            Eigen::Matrix2d flat;
            flat << star.faces[i].from - p, star.faces[i].to - p;
            const Eigen::Matrix2d jacobian = flat * rest[i].inverse();
            if (!(jacobian.determinant() > 0.0))
                return std::numeric_limits<double>::infinity();
            const double density =
                0.25 * (jacobian.squaredNorm() + jacobian.inverse().squaredNorm());
            sum += 0.5 * rest[i].determinant() *
                   (star.steepness > 0.0 ? std::exp(star.steepness * (density - 1.0)) : density);
        }
        return sum;
    }
    Vec2 gradient(const Vec2& p, double h) const {
        Vec2 g;
        for (int c = 0; c < 2; ++c) {
            const Vec2 d = h * Vec2::Unit(c);
            g[c] = (energy(p + d) - energy(p - d)) / (2.0 * h);
        }
        return g;
    }
    Eigen::Matrix2d hessian(const Vec2& p, double h) const {
        Eigen::Matrix2d m;
        for (int c = 0; c < 2; ++c) {
            const Vec2 d = h * Vec2::Unit(c);
            m.col(c) = (gradient(p + d, h) - gradient(p - d, h)) / (2.0 * h);
        }
        return m;
    }
};

// A polygon around the origin, its triangles to the origin, and rest triangles that differ from
// them by up to `strain`; open stars leave a part of the turn out.
Sample random_star(Random& random, double strain, bool open) {
    Sample sample;
    const Index n = 3 + random.below(7);
    const double turn = open ? random.uniform(0.5, 1.0) * pi : 2.0 * pi;
    std::vector<Vec2> ring;
    for (Index i = 0; i <= n; ++i) {
        const double t = turn * (i + (i == 0 || i == n ? 0.0 : random.uniform(-0.3, 0.3))) / n;
        ring.push_back(random.uniform(0.5, 1.5) * Vec2(std::cos(t), std::sin(t)));
    }
    if (!open)
        ring.back() = ring.front();
    for (std::size_t i = 0; i < at(n); ++i) {
        const auto length = [&](const Vec2& edge) {
            return edge.norm() * (1.0 + random.uniform(-strain, strain));
        };
        const RestTriangle rest = make_rest_triangle(
            {length(ring[i]), length(ring[i + 1] - ring[i]), length(ring[i + 1])}, 0.0);
        VertexStar::Face face;
        face.from = ring[i];
        face.to = ring[i + 1];
        face.area = rest.area;
        face.cot_apex = rest.cotangent[1];
        face.cot_from = rest.cotangent[2];
        face.cot_to = rest.cotangent[0];
        sample.star.faces.push_back(face);
        sample.rest.push_back(rest.edges);
    }
    return sample;
}

bool is_valid(const VertexStar& star, const Vec2& p) {
    for (const VertexStar::Face& f : star.faces)
        if (!(orientation(p, f.from, f.to) > 0.0))
            return false;
    return true;
}

VertexStar polygon_star(const std::vector<Vec2>& polygon) {
    VertexStar star;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        VertexStar::Face face;
        face.from = polygon[i];
        face.to = polygon[(i + 1) % polygon.size()];
        star.faces.push_back(face);
    }
    return star;
}

TEST(VertexRelaxation, EnergyIsThatOfTheJacobians) {
    Random random(11);
    for (int i = 0; i < 200; ++i) {
        Sample sample = random_star(random, 0.2, i % 2 == 0);
        sample.star.steepness = i % 5 == 0 ? 3.0 : 0.0;
        const Vec2 p(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
        const double expected = sample.energy(p);
        if (std::isfinite(expected)) {
            EXPECT_NEAR(sample.star.energy(p), expected, 1e-9 * expected);
        } else {
            EXPECT_FALSE(std::isfinite(sample.star.energy(p)));
        }
    }
    // An isometry costs a half of the area.
    const Sample exact = random_star(random, 0.0, false);
    double area = 0.0;
    for (const VertexStar::Face& f : exact.star.faces)
        area += f.area;
    EXPECT_NEAR(exact.star.energy(Vec2::Zero()), area, 1e-12 * area);
}

// Near its minimum the energy is convex, and the step is −H⁻¹ g; both from differences of the
// energy of Jacobians.
TEST(VertexRelaxation, StepsAreThoseOfNewtonsMethod) {
    Random random(12);
    int compared = 0;
    for (int i = 0; i < 100; ++i) {
        Sample sample = random_star(random, 0.1, i % 3 == 0);
        sample.star.steepness = i % 5 == 0 ? 3.0 : 0.0;
        Vec2 best = Vec2::Zero();
        for (int step = 0; step < 100; ++step)
            best = relax_vertex(sample.star, best);
        const Vec2 start = best + 1e-3 * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
        const Vec2 found = relax_vertex(sample.star, start) - start;
        const Vec2 expected = -sample.hessian(start, 1e-4).inverse() * sample.gradient(start, 1e-5);
        if (sample.energy(start + expected) >= sample.energy(start))
            continue; // the line search has to shorten it
        EXPECT_LT((found - expected).norm(), 1e-3 * expected.norm() + 1e-8);
        ++compared;
    }
    EXPECT_GT(compared, 80);
}

TEST(VertexRelaxation, RepeatedStepsEndWhereTheGradientVanishes) {
    Random random(13);
    for (int i = 0; i < 100; ++i) {
        const Sample sample = random_star(random, 0.15, i % 2 == 0);
        Vec2 p = Vec2::Zero();
        for (int step = 0; step < 400; ++step)
            p = relax_vertex(sample.star, p);
        EXPECT_LT(sample.gradient(p, 1e-6).norm(), 1e-5 * (1.0 + sample.energy(p)));
    }
}

TEST(VertexRelaxation, NoStepFlipsAFaceOrRaisesTheEnergy) {
    Random random(14);
    int moved = 0;
    for (int i = 0; i < 2000; ++i) {
        // Strains from none to rest triangles that are needles.
        Sample sample = random_star(random, i % 4 == 0 ? 0.9 : 0.3, i % 2 == 0);
        sample.star.steepness = i % 5 == 0 ? 3.0 : 0.0;
        Vec2 p(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
        if (!is_valid(sample.star, p))
            p = 1e-9 * p; // the origin sees all of a star that goes around
        if (!is_valid(sample.star, p))
            continue;
        const double before = sample.star.energy(p);
        const Vec2 q = relax_vertex(sample.star, p);
        EXPECT_TRUE(is_valid(sample.star, q));
        EXPECT_LE(sample.star.energy(q), before);
        moved += q == p ? 0 : 1;
    }
    EXPECT_GT(moved, 1000);
}

TEST(VertexRelaxation, AFlippedStartStaysWhereItIs) {
    Random random(15);
    const Sample sample = random_star(random, 0.1, false);
    const Vec2 outside(7.0, 5.0);
    EXPECT_EQ(relax_vertex(sample.star, outside), outside);
}

TEST(KernelPoint, LiesInTheKernel) {
    Random random(16);
    for (int i = 0; i < 500; ++i) {
        const Sample sample = random_star(random, 0.1, i % 3 == 0);
        const Vec2 hint(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0));
        EXPECT_TRUE(is_valid(sample.star, kernel_point(sample.star, hint)));
    }
}

TEST(KernelPoint, IsTheCentroidOfTheKernel) {
    const std::vector<Vec2> square = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    EXPECT_LT((kernel_point(polygon_star(square), {0.1, 0.1}) - Vec2(1, 1)).norm(), 1e-12);
    // An L: only its corner square sees everything.
    const std::vector<Vec2> bent = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
    EXPECT_LT((kernel_point(polygon_star(bent), {2.5, 0.5}) - Vec2(0.5, 0.5)).norm(), 1e-12);
    // A sliver, far from the origin.
    const std::vector<Vec2> sliver = {{1e4, 0}, {1e4 + 1, 0}, {1e4 + 1, 1e-7}, {1e4, 1e-7}};
    EXPECT_TRUE(is_valid(polygon_star(sliver), kernel_point(polygon_star(sliver), {1e4, 0})));
}

TEST(KernelPoint, AStarWithoutKernelKeepsTheHint) {
    // Three arms that bend away: no point sees all of them.
    std::vector<Vec2> swirl;
    for (int arm = 0; arm < 3; ++arm)
        for (const auto& [r, t] : {std::pair(0.3, 0.0), {1.0, 1.2}, {1.0, 1.6}, {0.3, 1.0}}) {
            const double angle = 2.0 * pi * arm / 3.0 + t;
            swirl.emplace_back(r * std::cos(angle), r * std::sin(angle));
        }
    const Vec2 hint(0.05, 0.02);
    const VertexStar star = polygon_star(swirl);
    ASSERT_FALSE(is_valid(star, hint));
    EXPECT_EQ(kernel_point(star, hint), hint);
}

TEST(TurnBack, InnerVerticesGoWhereNoFaceIsFlipped) {
    const checks::Disk disk(shapes::grid(6, 6));
    std::vector<Vec2> flat;
    for (const Vertex v : disk.surface.vertex)
        flat.emplace_back(disk.mesh.points[v].head<2>());
    ASSERT_EQ(count_flips(disk.problem, flat), 0);
    std::vector<std::uint8_t> on_outline(flat.size(), 0);
    for (const Vertex v : disk.problem.boundary)
        on_outline[v] = 1;
    for (std::size_t v = 0; v < flat.size(); ++v) {
        std::vector<Vec2> uv = flat;
        uv[v] += Vec2(0.4, 0.3); // past its neighbours
        if (count_flips(disk.problem, uv) == 0)
            continue;
        EXPECT_EQ(turn_back(disk.problem, uv), on_outline[v] == 0) << v;
        for (std::size_t w = 0; w < uv.size(); ++w)
            EXPECT_TRUE(w == v || on_outline[w] == 0 || uv[w] == flat[w]);
        EXPECT_TRUE(on_outline[v] != 0 || count_flips(disk.problem, uv) == 0);
    }
}

} // namespace
} // namespace devseg::flatten
