#include "devseg/metrics/conic_proxy.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::metrics {
namespace {

using shapes::pi;
using shapes::Random;

struct Sample {
    double area;
    Vec3 normal;
};

NormalMoments moments_of(const std::vector<Sample>& samples) {
    NormalMoments moments;
    for (const Sample& s : samples)
        moments.add(s.area, s.normal);
    return moments;
}

double total_error(const std::vector<Sample>& samples, const Vec3& axis, double cos_angle) {
    double sum = 0.0;
    for (const Sample& s : samples)
        sum += s.area * std::pow(axis.dot(s.normal) - cos_angle, 2);
    return sum;
}

// Normals at the given angle to the axis, over a part of the full turn.
std::vector<Sample> cone_normals(const Vec3& axis, double angle, double span, int count,
                                 Random& random) {
    const Vec3 u = axis.unitOrthogonal();
    const Vec3 v = axis.cross(u);
    std::vector<Sample> samples;
    for (int i = 0; i < count; ++i) {
        const double t = random.uniform(0.0, span);
        samples.push_back(
            {random.uniform(0.1, 2.0),
             std::cos(angle) * axis + std::sin(angle) * (std::cos(t) * u + std::sin(t) * v)});
    }
    return samples;
}

TEST(FitConic, RecoversConesAndCylindersOfRandomAxes) {
    Random random(11);
    for (int run = 0; run < 200; ++run) {
        const Vec3 axis = random.direction();
        const double angle = run % 4 == 0 ? 0.5 * pi : random.uniform(0.2, pi - 0.2);
        const double span = run % 2 == 0 ? 2.0 * pi : random.uniform(1.5, 5.0);
        const ConicProxy proxy = fit_conic(moments_of(cone_normals(axis, angle, span, 60, random)));
        const double sign = proxy.axis.dot(axis) < 0.0 ? -1.0 : 1.0; // (N, θ) is (−N, π − θ)
        EXPECT_LT((sign * proxy.axis - axis).norm(), 1e-9) << "run " << run;
        EXPECT_NEAR(sign * proxy.cos_angle, std::cos(angle), 1e-9) << "run " << run;
    }
}

TEST(FitConic, NarrowPatchesShowTheirAxis) {
    Random random(16);
    for (const double span : {0.02, 0.05, 0.1}) { // radians: far from planar up to rounding
        const Vec3 axis = random.direction();
        const ConicProxy proxy =
            fit_conic(moments_of(cone_normals(axis, 0.5 * pi, span, 400, random)));
        EXPECT_NEAR(std::abs(proxy.axis.dot(axis)), 1.0, 1e-6);
        EXPECT_NEAR(proxy.cos_angle, 0.0, 1e-6);
    }
}

TEST(FitConic, OfBothSignsTheLargestComponentIsPositive) {
    Random random(17);
    for (int run = 0; run < 100; ++run) {
        const Vec3 axis =
            fit_conic(moments_of(cone_normals(random.direction(), 1.2, 5.0, 12, random))).axis;
        Eigen::Index largest = 0;
        axis.cwiseAbs().maxCoeff(&largest);
        EXPECT_GT(axis[largest], 0.0);
    }
}

TEST(FitConic, APlaneTakesItsNormal) {
    Random random(12);
    for (int run = 0; run < 50; ++run) {
        const Vec3 normal = random.direction();
        std::vector<Sample> samples;
        for (int i = 0; i < 20; ++i) // as rounding leaves it
            samples.push_back(
                {random.uniform(0.1, 2.0), (normal + 1e-8 * random.direction()).normalized()});
        const ConicProxy proxy = fit_conic(moments_of(samples));
        EXPECT_LT((proxy.axis - normal).norm(), 1e-7);
        EXPECT_NEAR(proxy.cos_angle, 1.0, 1e-12);
    }
}

TEST(FitConic, NoAxisIsBetter) {
    Random random(13);
    for (int run = 0; run < 40; ++run) {
        std::vector<Sample> samples;
        const int count = 3 + random.below(30);
        const Vec3 lean = random.uniform(0.0, 2.0) * random.direction();
        for (int i = 0; i < count; ++i)
            samples.push_back(
                {random.uniform(0.01, 3.0), (random.direction() + lean).normalized()});
        const ConicProxy proxy = fit_conic(moments_of(samples));
        EXPECT_NEAR(proxy.axis.norm(), 1.0, 1e-12);
        EXPECT_LE(std::abs(proxy.cos_angle), 1.0);
        const double best = total_error(samples, proxy.axis, proxy.cos_angle);
        // Axes on a fine spiral over the sphere, each with its best angle and some others.
        constexpr int axes = 3000;
        double area = 0.0;
        Vec3 sum = Vec3::Zero();
        for (const Sample& s : samples) {
            area += s.area;
            sum += s.area * s.normal;
        }
        for (int i = 0; i < axes; ++i) {
            const double z = 1.0 - 2.0 * (i + 0.5) / axes;
            const double turn = i * pi * (3.0 - std::sqrt(5.0));
            const double r = std::sqrt(1.0 - z * z);
            const Vec3 axis(r * std::cos(turn), r * std::sin(turn), z);
            for (const double cos_angle : {axis.dot(sum) / area, random.uniform(-1.0, 1.0)})
                ASSERT_LE(best, total_error(samples, axis, cos_angle) + 1e-12 * area);
        }
        // And around the found one.
        for (int i = 0; i < 200; ++i) {
            const Vec3 axis = (proxy.axis + 1e-3 * random.direction()).normalized();
            ASSERT_LE(best, total_error(samples, axis, axis.dot(sum) / area) + 1e-12 * area);
        }
    }
}

TEST(FitConic, TheOrderOfFacesDoesNotMatter) {
    Random random(14);
    std::vector<Sample> samples = cone_normals(random.direction(), 1.1, 4.0, 80, random);
    for (Sample& s : samples) // no exact cone
        s.normal = (s.normal + 0.05 * random.direction()).normalized();
    const ConicProxy first = fit_conic(moments_of(samples));
    for (int run = 0; run < 20; ++run) {
        random.shuffle(samples);
        const ConicProxy proxy = fit_conic(moments_of(samples));
        EXPECT_LT((proxy.axis - first.axis).norm(), 1e-12); // the same sign, too
        EXPECT_NEAR(proxy.cos_angle, first.cos_angle, 1e-12);
    }
}

TEST(FitConic, AreasAreWeightsOnly) {
    Random random(15);
    std::vector<Sample> samples = cone_normals(random.direction(), 0.7, 3.0, 30, random);
    for (Sample& s : samples)
        s.normal = (s.normal + 0.1 * random.direction()).normalized();
    const ConicProxy once = fit_conic(moments_of(samples));
    std::vector<Sample> split; // each face cut into two
    for (const Sample& s : samples) {
        split.push_back({0.25e-6 * s.area, s.normal});
        split.push_back({0.75e-6 * s.area, s.normal});
    }
    const ConicProxy twice = fit_conic(moments_of(split));
    EXPECT_LT((once.axis - twice.axis).norm(), 1e-10);
    EXPECT_NEAR(once.cos_angle, twice.cos_angle, 1e-10);
}

TEST(FitConic, WithoutAreaTheProxyIsStillUsable) {
    for (const ConicProxy& proxy :
         {fit_conic(NormalMoments{}), fit_conic(moments_of({{0.0, Vec3::UnitX()}}))}) {
        EXPECT_NEAR(proxy.axis.norm(), 1.0, 1e-12);
        EXPECT_TRUE(std::abs(proxy.cos_angle) <= 1.0);
    }
}

TEST(FitConic, OpposedNormalsHaveAConeOfARightAngle) {
    // A thin sheet seen from both sides: the mean is zero, any axis in the plane fits exactly.
    const ConicProxy proxy = fit_conic(moments_of({{1.0, Vec3::UnitX()}, {1.0, -Vec3::UnitX()}}));
    EXPECT_NEAR(proxy.axis.dot(Vec3::UnitX()), 0.0, 1e-12);
    EXPECT_NEAR(proxy.cos_angle, 0.0, 1e-12);
}

TEST(FitConic, MeshesOfConesFitExactly) {
    for (const mesh::RawMesh& raw : {shapes::cone(24, 5), shapes::cylinder_tube(24, 5)}) {
        const Mesh mesh = checks::gated(raw);
        NormalMoments moments;
        for (const Face f : mesh.all_faces())
            moments.add(mesh.face_areas[f], mesh.face_normals[f]);
        const ConicProxy proxy = fit_conic(moments);
        EXPECT_NEAR(std::abs(proxy.axis.z()), 1.0, 1e-9);
        for (const Vec3& normal : mesh.face_normals)
            EXPECT_LT(proxy.fitting_error(normal), 1e-18);
    }
}

TEST(ConicProxy, FittingErrorIsTheSquaredDifferenceOfCosines) {
    const ConicProxy proxy{Vec3::UnitZ(), 0.25};
    EXPECT_DOUBLE_EQ(proxy.fitting_error(Vec3::UnitZ()), 0.5625);
    EXPECT_DOUBLE_EQ(proxy.fitting_error(Vec3::UnitX()), 0.0625);
    EXPECT_DOUBLE_EQ(proxy.fitting_error(-Vec3::UnitZ()), 1.5625);
    EXPECT_DOUBLE_EQ((ConicProxy{Vec3::UnitZ(), -1.0}.fitting_error(Vec3::UnitZ())), 4.0);
}

} // namespace
} // namespace devseg::metrics
