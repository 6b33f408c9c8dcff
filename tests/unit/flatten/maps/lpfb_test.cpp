#include "devseg/flatten/maps/lpfb.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/abf.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;
using shapes::pi;
using shapes::Random;

struct Boundary {
    std::vector<double> lengths;
    std::vector<double> angles;
};

// Edge lengths and inner angles of a polygon.
Boundary measure(const std::vector<Vec2>& points) {
    Boundary boundary;
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 ahead = points[(i + 1) % n] - points[i];
        const Vec2 back = points[(i + n - 1) % n] - points[i];
        const double angle =
            std::atan2(ahead.x() * back.y() - ahead.y() * back.x(), ahead.dot(back));
        boundary.lengths.push_back(ahead.norm());
        boundary.angles.push_back(angle < 0.0 ? angle + 2.0 * pi : angle);
    }
    return boundary;
}

// A star-shaped polygon with two to five bays.
std::vector<Vec2> star(Random& random) {
    const Index n = 20 + random.below(180);
    const double depth = random.uniform(0.0, 0.5);
    const Index bays = 2 + random.below(4);
    std::vector<Vec2> points;
    for (Index i = 0; i < n; ++i) {
        const double t = 2.0 * pi * i / n;
        points.push_back((1.0 + depth * std::cos(bays * t)) * Vec2(std::cos(t), std::sin(t)));
    }
    return points;
}

// Roughly normal, with the given standard deviation.
double noise(Random& random, double deviation) {
    return deviation *
           (random.uniform(-1.5, 1.5) + random.uniform(-1.5, 1.5) + random.uniform(-1.5, 1.5)) /
           1.5;
}

void add_noise(Boundary& boundary, Random& random, double of_angles, double of_lengths) {
    for (double& angle : boundary.angles)
        angle = std::clamp(angle + noise(random, of_angles), 0.05, 2.0 * pi - 0.05);
    for (double& length : boundary.lengths)
        length *= std::exp(noise(random, of_lengths));
}

ClosedBoundary close(const Boundary& boundary) {
    return close_boundary(boundary.lengths, boundary.angles, LpfbOptions{}, Progress{});
}

void expect_lengths(const std::vector<Vec2>& points, const std::vector<double>& lengths) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double length = (points[(i + 1) % points.size()] - points[i]).norm();
        EXPECT_NEAR(length, lengths[i], 1e-9 * lengths[i]);
    }
}

std::vector<Vec2> boundary_of(const Disk& disk, const std::vector<Vec2>& uv) {
    std::vector<Vec2> points;
    for (const Index v : disk.problem.boundary)
        points.push_back(uv[v]);
    return points;
}

LpfbResult flatten(const Disk& disk) {
    return flatten_lpfb(disk.problem, LpfbOptions{}, Progress{});
}

TEST(Lpfb, PolygonsKeepTheirShape) {
    Random random(5);
    for (int round = 0; round < 50; ++round) {
        const std::vector<Vec2> polygon = star(random);
        const ClosedBoundary closed = close(measure(polygon));
        EXPECT_LT(closed.deviation, 1e-12);
        for (std::size_t i = 0; i < polygon.size(); ++i)
            EXPECT_NEAR((closed.points[i] - closed.points[0]).norm(),
                        (polygon[i] - polygon[0]).norm(), 1e-11);
    }
}

TEST(Lpfb, NoisyBoundariesNeverFail) {
    using Noise = std::pair<double, double>;
    Random random(3);
    int newton = 0;
    for (const auto& [of_angles, of_lengths] :
         {Noise(0.05, 0.05), Noise(0.15, 0.2), Noise(0.3, 0.4), Noise(0.5, 0.6)})
        for (int round = 0; round < 100; ++round) {
            Boundary boundary = measure(star(random));
            add_noise(boundary, random, of_angles, of_lengths);
            const ClosedBoundary closed = close(boundary);
            newton += closed.solver == BoundarySolver::newton ? 1 : 0;
            EXPECT_LT(closed.closure, 1e-9);
            expect_lengths(closed.points, boundary.lengths);
            const double sum = std::accumulate(closed.angles.begin(), closed.angles.end(), 0.0);
            EXPECT_NEAR(sum, pi * (static_cast<double>(closed.angles.size()) - 2.0), 1e-9);
        }
    EXPECT_GE(newton, 360); // the fallbacks are the exception
}

TEST(Lpfb, ClosedAnglesAreTheNearestOnes) {
    // At the least change, the change is a combination of the gradients of the three conditions,
    // which are 1, x and y of the vertices: turning at p moves the end of the walk around p.
    Random random(11);
    for (int round = 0; round < 20; ++round) {
        Boundary boundary = measure(star(random));
        add_noise(boundary, random, 0.1, 0.1);
        const ClosedBoundary closed = close(boundary);
        ASSERT_EQ(closed.solver, BoundarySolver::newton);
        Eigen::VectorXd change(static_cast<Eigen::Index>(closed.points.size()));
        Eigen::MatrixX3d gradients(change.size(), 3);
        for (Eigen::Index i = 0; i < change.size(); ++i) {
            const auto k = static_cast<std::size_t>(i);
            gradients.row(i) << 1.0, closed.points[k].x(), closed.points[k].y();
            change[i] = closed.angles[k] - boundary.angles[k];
        }
        const Eigen::VectorXd fit = gradients * gradients.colPivHouseholderQr().solve(change);
        EXPECT_LT((change - fit).norm(), 1e-4 * change.norm());
    }
}

TEST(Lpfb, ImpossibleBoundariesAreRefused) {
    EXPECT_THROW(close({{1.0, 1.0, 3.0}, {1.0, 1.0, 1.0}}), NumericalFailure);
    EXPECT_THROW(close({{1.0, 1.0, 1.0, 9.0}, {1.5, 1.5, 1.5, 1.5}}), NumericalFailure);
    EXPECT_NO_THROW(close({{1.0, 1.0, 1.9}, {1.0, 1.0, 1.0}}));
    EXPECT_NO_THROW(close({{1.0, 0.0, 1.0, 1.0}, {1.0, 2.0, 1.5, 1.0}})); // an edge of no length
}

TEST(Lpfb, DevelopablesAreFlattenedIsometrically) {
    const auto ruling = [](const Vec3& p) { return std::abs(p.y()) < 1e-12 && p.x() > 0.0; };
    for (const Disk& disk :
         {Disk(shapes::grid(5, 4)), Disk(shapes::cylinder_tube(24, 7)),
          Disk(shapes::cone(24, 7), ruling), Disk(shapes::folded_strip(20, 5, 0.2))}) {
        const LpfbResult result = flatten(disk);
        EXPECT_EQ(result.flips, 0);
        EXPECT_EQ(result.mended, 0);
        EXPECT_LT(result.boundary.deviation, 1e-9);
        for (std::size_t f = 0; f < disk.problem.faces.size(); ++f)
            for (const double s : checks::stretches(disk.problem, result.uv, f))
                EXPECT_NEAR(s, 1.0, 1e-6);
    }
}

TEST(Lpfb, BoundaryLengthsAreKeptOnCurvedCharts) {
    for (const Disk& disk :
         {Disk(shapes::hemisphere(20, 8)), Disk(shapes::torus(14, 9)), Disk(shapes::sphere(2)),
          Disk(shapes::with_noise(shapes::grid(12, 12), 0.05, 3))}) {
        const LpfbResult result = flatten(disk);
        EXPECT_LT(result.boundary.closure, 1e-9);
        expect_lengths(boundary_of(disk, result.uv), disk.problem.boundary_edge);
        EXPECT_EQ(result.flips, checks::count_flips(disk.problem.faces, result.uv));
    }
}

TEST(Lpfb, BothSidesOfADartAreEquallyLong) {
    // A hemisphere with a dart halfway up: each of its edges is twice on the boundary.
    const Disk disk(shapes::hemisphere(20, 10), [](const Vec3& p) {
        return std::abs(p.y()) < 1e-12 && p.x() > 0.0 && p.z() < 0.4;
    });
    const LpfbResult result = flatten(disk);
    EXPECT_EQ(result.flips, 0);
    int pairs = 0;
    const atlas::ChartSurface& surface = disk.surface;
    const auto length = [&](Index h) {
        return (result.uv[surface.target(h)] - result.uv[surface.origin(h)]).norm();
    };
    for (const Index h : surface.loops.front())
        for (const Index g : surface.loops.front())
            if (disk.mesh.twin[surface.mesh_half_edge(h)] == surface.mesh_half_edge(g)) {
                EXPECT_NEAR(length(h), length(g), 1e-9 * length(h));
                ++pairs;
            }
    EXPECT_GE(pairs, 6); // each counted from both sides
}

TEST(Lpfb, AnglesOfAMapKeepTheBoundaryFromCrossingItself) {
    for (const Disk& disk : {Disk(shapes::sphere(2)), Disk(shapes::capped_cylinder(12, 6))}) {
        EXPECT_GT(flatten(disk).flips, 0); // far from developable
        const AbfResult map = flatten_abf(disk.problem, AbfOptions{}, Progress{});
        const LpfbResult result = flatten_lpfb(disk.problem, boundary_angles(disk.problem, map.uv),
                                               LpfbOptions{}, Progress{});
        EXPECT_EQ(checks::count_flips(disk.problem.faces, result.uv), 0);
        expect_lengths(boundary_of(disk, result.uv), disk.problem.boundary_edge);
    }
}

// Pulls on each inner vertex of the map: by cotangent weights, or by mean-value weights.
std::vector<Vec2> pulls(const FlatteningProblem& problem, const std::vector<Vec2>& uv,
                        bool mean_value) {
    std::vector<Vec2> pull(uv.size(), Vec2::Zero());
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const std::array<Vec2, 3> rest = {Vec2::Zero(), problem.edges[f].col(0),
                                          problem.edges[f].col(1)};
        for (std::size_t c = 0; c < 3; ++c)
            for (const std::size_t other : {(c + 1) % 3, (c + 2) % 3}) {
                const Triangle& t = problem.faces[f];
                const Vec2 edge = rest[other] - rest[c];
                const Vec2 third = rest[3 - c - other] - rest[c];
                const double cosine = edge.dot(third) / (edge.norm() * third.norm());
                const double tangent = std::sqrt((1.0 - cosine) / (1.0 + cosine)); // of the half
                const double angle =
                    std::acos((edge - third).dot(-third) / ((edge - third).norm() * third.norm()));
                const double w = mean_value ? tangent / edge.norm() : 1.0 / std::tan(angle);
                pull[t[c]] += w * (uv[t[other]] - uv[t[c]]);
            }
    }
    for (const Index v : problem.boundary)
        pull[v].setZero();
    return pull;
}

TEST(Lpfb, MeanValueWeightsMendFlippedFaces) {
    for (const std::uint32_t seed : {0u, 2u, 4u, 50u}) {
        const Disk disk(shapes::with_noise(shapes::grid(8, 8), 0.1, seed));
        const LpfbResult result = flatten(disk);
        EXPECT_GT(result.mended, 0);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, result.uv), 0);
        expect_lengths(boundary_of(disk, result.uv), disk.problem.boundary_edge);
        const std::vector<Vec2> cotangent = pulls(disk.problem, result.uv, false);
        const std::vector<Vec2> mean_value = pulls(disk.problem, result.uv, true);
        Index mended = 0;
        for (std::size_t v = 0; v < cotangent.size(); ++v)
            if (cotangent[v].norm() > 1e-9) {
                EXPECT_LT(mean_value[v].norm(), 1e-9);
                ++mended;
            }
        EXPECT_EQ(mended, result.mended);
    }
}

TEST(Lpfb, ThinTrianglesGiveFiniteMapsOrFailures) {
    for (const double width : {1e-2, 1e-4, 1e-6, 0.0})
        for (const std::uint32_t seed : {1u, 2u}) {
            // Needles, with vertices that lie almost on the opposite edges.
            mesh::RawMesh raw = shapes::with_noise(shapes::grid(6, 40), 1e-3, seed);
            for (Vec3& p : raw.points)
                p.x() *= width;
            const Disk disk(raw);
            try {
                for (const Vec2& p : flatten(disk).uv)
                    EXPECT_TRUE(p.allFinite());
            } catch (const NumericalFailure&) { // said, not hidden
            }
        }
}

TEST(Lpfb, LengthsAreGivenBackByShortMoves) {
    Random random(7);
    std::vector<Vec2> points;
    for (int i = 0; i < 60; ++i) {
        const double t = 2.0 * pi * i / 60.0;
        points.emplace_back((2.0 + 0.2 * (i % 2)) * std::cos(t), std::sin(t));
    }
    std::vector<double> lengths = measure(points).lengths;
    for (double& length : lengths)
        length *= 1.0 + random.uniform(-0.05, 0.05);
    const auto restored = restore_lengths(points, lengths, Progress{});
    ASSERT_TRUE(restored.has_value());
    const Boundary after = measure(*restored);
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        EXPECT_NEAR(after.lengths[i], lengths[i], 1e-6 * lengths[i]);
        EXPECT_LT(((*restored)[i] - points[i]).norm(), 0.1);
    }
    lengths[0] = 100.0; // longer than all others together
    EXPECT_FALSE(restore_lengths(points, lengths, Progress{}).has_value());
}

TEST(Lpfb, OneTriangleKeepsItsShape) {
    const Disk disk(mesh::RawMesh{{{0, 0, 0}, {5, 1, 2}, {1, 3, -1}}, {{0, 1, 2}}});
    for (const double s : checks::stretches(disk.problem, flatten(disk).uv, 0))
        EXPECT_NEAR(s, 1.0, 1e-12);
}

TEST(Lpfb, RunsAreEqualAndCanBeCancelled) {
    const Disk disk(shapes::torus(14, 9));
    EXPECT_EQ(flatten(disk).uv, flatten(disk).uv);
    Progress stopped([](double, const char*) { return false; });
    EXPECT_THROW(stopped.update(0.0), Cancelled);
    EXPECT_THROW(flatten_lpfb(disk.problem, LpfbOptions{}, stopped), Cancelled);
}

} // namespace
} // namespace devseg::flatten
