#include "devseg/pattern/cloth_strain.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "unit/pattern_samples.h"

namespace devseg::pattern {
namespace {

// Faces so small that curved surfaces are flat on them: what remains is a thousandth of 1e-6.
constexpr double tiny = 1e-6;

// A surface over parameters, with its map to the paper, sampled by one tiny face at each place.
struct Sampled {
    Mesh mesh;
    std::vector<Vec2> paper;
    std::vector<Index> faces;
};

template <class Surface, class Paper>
Sampled sample(const std::vector<Vec2>& places, Surface surface, Paper paper) {
    mesh::RawMesh raw;
    Sampled result;
    for (const Vec2& place : places) {
        const Index first = static_cast<Index>(raw.points.size());
        for (const Vec2& step : {Vec2(0.0, 0.0), Vec2(tiny, 0.0), Vec2(0.0, tiny)}) {
            const Vec3 p = surface(Vec2(place + step));
            raw.points.push_back(p);
            result.paper.push_back(paper(Vec2(place + step)));
        }
        raw.faces.push_back({first, first + 1, first + 2});
        result.faces.push_back(static_cast<Index>(result.faces.size()));
    }
    result.mesh.points = raw.points;
    result.mesh.faces = raw.faces;
    result.mesh.face_areas.assign(raw.faces.size(), 1.0);
    return result;
}

std::vector<Vec2> grid(double width, double low, double high) {
    std::vector<Vec2> places;
    for (int i = 0; i <= 20; ++i)
        for (int j = 0; j <= 20; ++j)
            places.emplace_back(width * (i / 10.0 - 1.0), low + (high - low) * j / 20.0);
    return places;
}

material::Material cloth(double warp, double weft, double bias, double compression) {
    material::Material m;
    m.warp = warp;
    m.weft = weft;
    m.bias = bias;
    m.compression = compression;
    return m;
}

ClothStrain strain_of(const Sampled& s, const Vec2& grain, const material::Material& m) {
    return measure_cloth(face_metrics(s.mesh, s.paper, s.faces, 1.0), grain, m);
}

TEST(ClothStrain, OfAStretchedCylinderIsThatOfItsAxes) {
    const double around = 1.04; // on the model, over the paper
    const double along = 0.97;
    const Sampled s = sample(
        grid(1.0, 0.0, 3.0),
        [](const Vec2& p) { return Vec3(std::sin(p.x()), p.y(), std::cos(p.x())); },
        [&](const Vec2& p) { return Vec2(p.x() / around, p.y() / along); });
    const ClothStrain upright = strain_of(s, Vec2::UnitY(), cloth(0.1, 0.05, 0.1, 0.06));
    EXPECT_NEAR(upright.along, 0.03, 1e-6);
    EXPECT_NEAR(upright.across, 0.04, 1e-6);
    EXPECT_NEAR(upright.along_95, 0.03, 1e-6);
    EXPECT_NEAR(upright.use_99, 0.04 / 0.05, 1e-6);
    EXPECT_TRUE(upright.is_within);
    // Now 4 % are along the grain.
    const ClothStrain lying = strain_of(s, Vec2::UnitX(), cloth(0.02, 0.05, 0.1, 0.06));
    EXPECT_NEAR(lying.along, 0.04, 1e-6);
    EXPECT_NEAR(lying.use_99, 2.0, 1e-6);
    EXPECT_FALSE(lying.is_within);
}

TEST(ClothStrain, UsesOfLimitsHaveASign) {
    const Sampled s = sample(
        grid(1.0, 0.0, 3.0),
        [](const Vec2& p) { return Vec3(std::sin(p.x()), p.y(), std::cos(p.x())); },
        [&](const Vec2& p) { return Vec2(p.x() / 1.04, p.y() / 0.97); });
    Pattern pattern;
    pattern.mesh = s.mesh;
    pattern.corner_place = s.paper;
    pattern.face_piece.assign(s.mesh.faces.size(), 0);
    pattern.face_piece.front() = -1;
    pattern.pieces.emplace_back();
    pattern.material = cloth(0.1, 0.05, 0.1, 0.06); // 4 % across the grain
    std::vector<double> uses = limit_uses(pattern, 1.0);
    EXPECT_EQ(uses.front(), 0.0);
    EXPECT_NEAR(uses.back(), 0.04 / 0.05, 1e-6);
    pattern.material = cloth(0.1, 0.1, 0.1, 0.02); // 3 % shorter along it
    EXPECT_NEAR(limit_uses(pattern, 1.0).back(), -0.03 / 0.02, 1e-6);
}

TEST(ClothStrain, OfAConeThatIsUnrolledIsNone) {
    const double half_angle = 0.5;
    const Sampled s = sample(
        grid(1.0, 1.0, 3.0),
        [&](const Vec2& p) {
            return Vec3(p.y() * std::sin(half_angle) * std::sin(p.x()),
                        -p.y() * std::cos(half_angle),
                        p.y() * std::sin(half_angle) * std::cos(p.x()));
        },
        [&](const Vec2& p) {
            const double turn = std::sin(half_angle) * p.x();
            return Vec2(p.y() * std::sin(turn), -p.y() * std::cos(turn));
        });
    const ClothStrain strain = strain_of(s, Vec2::UnitY(), cloth(0.01, 0.01, 0.01, 0.01));
    EXPECT_NEAR(strain.along, 0.0, 1e-6);
    EXPECT_NEAR(strain.across, 0.0, 1e-6);
    EXPECT_NEAR(strain.worst_use, 0.0, 1e-4); // shares of 1 %
}

TEST(ClothStrain, OfASphericalGoreGrowsToItsSide) {
    // Circles of latitude keep their lengths and lie level: x = λ cos φ, y = φ. The cloth is
    // sheared by λ sin φ then: lines up get longer by the root of 1 + (λ sin φ)².
    const double half = 0.3;
    const double top = 1.2;
    const Sampled s = sample(
        grid(half, 0.0, top),
        [](const Vec2& p) {
            return Vec3(std::cos(p.y()) * std::sin(p.x()), std::sin(p.y()),
                        std::cos(p.y()) * std::cos(p.x()));
        },
        [](const Vec2& p) { return Vec2(p.x() * std::cos(p.y()), p.y()); });
    const double shear = half * std::sin(top);
    const ClothStrain strain = strain_of(s, Vec2::UnitY(), cloth(0.1, 0.1, 0.1, 0.1));
    EXPECT_NEAR(strain.along, std::sqrt(1.0 + shear * shear) - 1.0, 1e-6);
    EXPECT_NEAR(strain.across, 0.0, 1e-6);
    // The singular values of a shear by s are those of (s ± sqrt(s² + 4)) / 2.
    const double longest = 0.5 * (shear + std::sqrt(shear * shear + 4.0));
    EXPECT_NEAR(strain.worst_use, (longest - 1.0) / 0.1, 1e-4);
}

TEST(ClothStrain, GrainFitsBestWhereTheClothGives) {
    // 6 % longer along x, and cloth that gives across its threads alone.
    const Sampled s = sample(
        grid(1.0, 0.0, 1.0), [](const Vec2& p) { return Vec3(1.06 * p.x(), p.y(), 0.0); },
        [](const Vec2& p) { return p; });
    const auto metrics = face_metrics(s.mesh, s.paper, s.faces, 1.0);
    const material::Material m = cloth(0.01, 0.08, 0.06, 0.05);
    PatternOptions options;
    const Vec2 best = choose_grain(metrics, options, &m, Vec2::UnitX());
    EXPECT_GT(std::abs(best.y()), 0.95);
    EXPECT_TRUE(measure_cloth(metrics, best, m).is_within);
    EXPECT_FALSE(measure_cloth(metrics, Vec2::UnitX(), m).is_within);
    options.grain = GrainDirection::longest;
    EXPECT_EQ(choose_grain(metrics, options, &m, Vec2::UnitX()), Vec2(Vec2::UnitX()));
    options.grain = GrainDirection::angle;
    options.grain_angle = 90.0;
    EXPECT_NEAR(choose_grain(metrics, options, &m, Vec2::UnitX()).x(), -1.0, 1e-12);
    options.grain = GrainDirection::up; // y of the model is y of the paper
    EXPECT_NEAR(choose_grain(metrics, options, &m, Vec2::UnitX()).y(), 1.0, 1e-9);
}

TEST(ClothStrain, IsToldOfEachPieceOfAPattern) {
    const Pattern plain = samples::two_pieces().pattern();
    EXPECT_FALSE(plain.material);
    PatternOptions options;
    options.material = "leather";
    const Pattern flat = samples::two_pieces().pattern(options);
    for (const PatternPiece& piece : flat.pieces) {
        EXPECT_TRUE(piece.cloth.is_within);
        EXPECT_LT(piece.cloth.along, 1e-6);
    }
    options.material = "silk";
    EXPECT_THROW(samples::two_pieces().pattern(options), InvalidParameter);
}

} // namespace
} // namespace devseg::pattern
