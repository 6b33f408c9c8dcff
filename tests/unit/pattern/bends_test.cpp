// Pieces of thick material that bend.
#include "devseg/pattern/bends.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/pattern_samples.h"
#include "unit/shapes.h"

namespace devseg::pattern {
namespace {

// A sheet 120 mm wide that bends along its middle by an angle, in `facets` + 1 steps of equal
// length `radius` · angle / facets; both legs are 60 mm long. Unrolled in the texture.
samples::Cloth bracket(double angle, double radius, int facets) {
    std::vector<Vec3> profile{Vec3(0, 0, 0)}; // outer side: the sheet runs along −x, then down
    std::vector<double> arc{0.0};
    double heading = 0.0;
    const auto go = [&](double length) {
        profile.push_back(profile.back() +
                          length * Vec3(std::cos(heading), 0.0, -std::sin(heading)));
        arc.push_back(arc.back() + length);
    };
    go(60.0);
    for (int i = 0; i < facets; ++i) {
        heading += angle / facets;
        if (i + 1 < facets)
            go(2.0 * radius * std::sin(0.5 * angle / facets));
    }
    go(60.0);
    mesh::RawMesh raw;
    for (const Vec3& p : profile)
        for (const double y : {0.0, 120.0})
            raw.points.push_back(p + Vec3(0.0, y, 0.0));
    std::vector<std::pair<Vec3, double>> known;
    for (std::size_t i = 0; i < profile.size(); ++i)
        known.emplace_back(profile[i], arc[i]);
    for (Index i = 0; i + 1 < static_cast<Index>(profile.size()); ++i) {
        raw.faces.push_back({2 * i, 2 * i + 2, 2 * i + 3});
        raw.faces.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    }
    samples::Cloth cloth;
    cloth.add(raw, [known](const Vec3& p, const Vec3&) {
        double best = infinite;
        double place = 0.0;
        for (const auto& [at, s] : known) {
            const double d = std::hypot(p.x() - at.x(), p.z() - at.z());
            place = d < best ? s : place;
            best = std::min(best, d);
        }
        return Vec2(place, p.y());
    });
    return cloth;
}

Vec2 size_of(const samples::Cloth& cloth, const PatternOptions& options) {
    const Pattern pattern = cloth.pattern(options);
    EXPECT_EQ(pattern.pieces.size(), 1u);
    return pattern.pieces.front().box.sizes();
}

TEST(Bends, BracketWithAnInnerRadiusOf8) {
    PatternOptions options;
    options.bend_radius_mm = 8.0;
    const Vec2 size = size_of(bracket(0.5 * pi, 0.0, 1), options);
    EXPECT_NEAR(size.y(), 120.00, 0.05);
    EXPECT_NEAR(size.x(), 116.57, 0.05);
}

TEST(Bends, TakeTheNeutralLineOfSheetMetal) {
    // Setback (R + T) tan 45° on both legs, and the arc of the neutral line.
    PatternOptions options;
    options.thickness_mm = 2.0;
    options.bend_radius_mm = 3.0;
    options.k_factor = 0.4;
    const double flat = 2.0 * (60.0 - 5.0) + 0.5 * pi * (3.0 + 0.4 * 2.0);
    EXPECT_NEAR(size_of(bracket(0.5 * pi, 0.0, 1), options).x(), flat, 1e-6);
    // Seen from the other side, the legs are those of the inner side.
    const double inner = 2.0 * (60.0 - 3.0) + 0.5 * pi * (3.0 + 0.4 * 2.0);
    EXPECT_NEAR(size_of(bracket(-0.5 * pi, 0.0, 1), options).x(), inner, 1e-6);
    options.bend_radius_mm = -1.0;
    options.k_factor = -1.0;
    options.material = "sheet-metal"; // of radius 1 and K 0.44
    const double thin = 2.0 * (60.0 - 3.0) + 0.5 * pi * (1.0 + 0.44 * 2.0);
    EXPECT_NEAR(size_of(bracket(0.5 * pi, 0.0, 1), options).x(), thin, 1e-6);
}

TEST(Bends, RoundOnesHaveTheirRadius) {
    // A quarter of radius 30, with foam of 10 mm inside: its middle has radius 25.
    PatternOptions options;
    options.thickness_mm = 10.0;
    options.material = "foam";
    const int facets = 60;
    const Vec2 without = size_of(bracket(0.5 * pi, 30.0, facets), {});
    const Vec2 with = size_of(bracket(0.5 * pi, 30.0, facets), options);
    EXPECT_NEAR(without.x() - with.x(), 0.5 * pi * 5.0, 0.01);
    EXPECT_NEAR(with.y(), 120.0, 1e-6);
}

TEST(Bends, ThatContradictEachOtherAreLeftAlone) {
    PatternOptions options;
    options.thickness_mm = 2.0;
    const Pattern plain = samples::unfinished().pattern();
    const Pattern thick = samples::unfinished().pattern(options);
    ASSERT_EQ(plain.pieces.size(), thick.pieces.size());
    bool any = false;
    for (const std::string& note : thick.notes)
        any = any || note.find("the thickness is left out on") != std::string::npos;
    EXPECT_TRUE(any);
}

} // namespace
} // namespace devseg::pattern
