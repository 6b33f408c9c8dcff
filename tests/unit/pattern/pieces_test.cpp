#include "devseg/pattern/pieces.h"

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/mesh/input_gate.h"

namespace devseg::pattern {
namespace {

constexpr double pi = 3.14159265358979323846;

// A mesh as a user would bring it: triangles with texture coordinates at their corners.
struct Model {
    mesh::RawMesh raw;
    std::vector<std::array<Vec2, 3>> uv;

    void add(const Vec3& a, const Vec3& b, const Vec3& c,
             const std::function<Vec2(const Vec3&)>& place) {
        Triangle t{};
        const std::array<Vec3, 3> corners = {a, b, c};
        for (std::size_t k = 0; k < 3; ++k)
            t[k] = vertex(corners[k]);
        raw.faces.push_back(t);
        uv.push_back({place(a), place(b), place(c)});
    }
    void add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                  const std::function<Vec2(const Vec3&)>& place) {
        add(a, b, c, place);
        add(a, c, d, place);
    }

private:
    Index vertex(const Vec3& p) {
        for (std::size_t v = 0; v < raw.points.size(); ++v)
            if ((raw.points[v] - p).norm() < 1e-12)
                return static_cast<Index>(v);
        raw.points.push_back(p);
        return static_cast<Index>(raw.points.size()) - 1;
    }
};

Pattern pattern_of(const Model& model, const PatternOptions& options = {}) {
    const mesh::GatedMesh gated = mesh::gate_mesh(model.raw);
    CornerUv uv;
    for (const Face f : gated.mesh.all_faces())
        for (Index k = 0; k < 3; ++k)
            uv.push_back(model.uv[gated.source_face[f]][gated.source_corner(f, k)]);
    Progress progress;
    return make_pattern(gated.mesh, uv, options, progress);
}

Vec2 flat(const Vec3& p) {
    return p.head<2>();
}

// Unit squares at the given places of a flat sheet.
Model squares(const std::vector<Vec2>& places, const std::function<Vec2(const Vec3&)>& place) {
    Model model;
    for (const Vec2& low : places) {
        const Vec3 a(low.x(), low.y(), 0.0);
        model.add_quad(a, a + Vec3(1, 0, 0), a + Vec3(1, 1, 0), a + Vec3(0, 1, 0), place);
    }
    return model;
}

// An L of three unit squares: unlike a square, it shows when it is mirrored.
Model letter_l(const Vec2& corner, const std::function<Vec2(const Vec3&)>& place) {
    return squares({corner, corner + Vec2(1, 0), corner + Vec2(0, 1)}, place);
}

void append(Model& model, const Model& other) {
    const Index offset = static_cast<Index>(model.raw.points.size());
    model.raw.points.insert(model.raw.points.end(), other.raw.points.begin(),
                            other.raw.points.end());
    for (const Triangle& t : other.raw.faces)
        model.raw.faces.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    model.uv.insert(model.uv.end(), other.uv.begin(), other.uv.end());
}

double area_of(const std::vector<Vec2>& points) {
    double twice = 0.0;
    for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++)
        twice += points[j].x() * points[i].y() - points[i].x() * points[j].y();
    return twice / 2.0;
}

double length_of(const std::vector<Vec2>& points) {
    double length = 0.0;
    for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++)
        length += (points[i] - points[j]).norm();
    return length;
}

// The same corners in the same turn around the piece, wherever it lies.
void expect_same_shape(const PatternPiece& a, const PatternPiece& b) {
    ASSERT_EQ(a.outer.points.size(), b.outer.points.size());
    const auto find = [&](const Vec2& local) {
        for (const Vec2& p : b.outer.points)
            if ((p - b.box.min() - local).norm() < 1e-9)
                return true;
        return false;
    };
    for (const Vec2& p : a.outer.points)
        EXPECT_TRUE(find(p - a.box.min())) << p.transpose();
}

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Pieces, FlatSheetKeepsItsSizeAtAnyScaleOfTheTexture) {
    for (const double uv_scale : {1e-6, 0.1, 1.0, 5e4}) {
        Model model;
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 4; ++j) {
                const Vec3 a(i * 0.5, j * 0.5, 7.0);
                model.add_quad(
                    a, a + Vec3(0.5, 0, 0), a + Vec3(0.5, 0.5, 0), a + Vec3(0, 0.5, 0),
                    [&](const Vec3& p) { return Vec2(uv_scale * (flat(p) + Vec2(0.3, -0.2))); });
            }
        PatternOptions options;
        options.mm_per_unit = 20.0;
        const Pattern pattern = pattern_of(model, options);
        ASSERT_EQ(pattern.pieces.size(), 1u);
        const PatternPiece& piece = pattern.pieces.front();
        EXPECT_EQ(piece.name, "P01");
        EXPECT_NEAR(pattern.width, 60.0, 1e-8);
        EXPECT_NEAR(pattern.height, 40.0, 1e-8);
        EXPECT_NEAR(piece.area, 2400.0, 1e-6);
        EXPECT_NEAR(area_of(piece.outer.points), piece.area, 1e-6); // counterclockwise
        EXPECT_NEAR(length_of(piece.outer.points), 200.0, 1e-7);
        EXPECT_NE(piece.outer.points.front(), piece.outer.points.back());
        EXPECT_TRUE(piece.holes.empty());
        EXPECT_NEAR(piece.label_radius, 20.0, 0.5);
        EXPECT_TRUE(pattern.notes.empty());
    }
}

TEST(Pieces, RingHasAHoleAndItsLabelLiesInTheRing) {
    Model model;
    const int count = 96;
    const auto on_circle = [&](double radius, int i) {
        const double angle = 2.0 * pi * (i % count) / count;
        return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.0);
    };
    for (int i = 0; i < count; ++i)
        model.add_quad(on_circle(1, i), on_circle(3, i), on_circle(3, i + 1), on_circle(1, i + 1),
                       flat);
    const PatternPiece piece = pattern_of(model).pieces.at(0);
    const double polygon = 0.5 * count * std::sin(2.0 * pi / count);
    ASSERT_EQ(piece.holes.size(), 1u);
    EXPECT_NEAR(piece.outer.area, 9.0 * polygon, 1e-9);
    EXPECT_NEAR(piece.holes[0].area, -polygon, 1e-9); // clockwise
    EXPECT_NEAR(piece.area, 8.0 * polygon, 1e-9);
    const double radius = (piece.label_position - Vec2(3, 3)).norm();
    EXPECT_NEAR(radius, 2.0, 0.1);
    EXPECT_NEAR(piece.label_radius, 1.0, 0.05);
}

TEST(Pieces, CubeHasSixPiecesWithNamesInOrder) {
    Model model;
    const std::array<std::array<Vec3, 3>, 6> sides = {{
        {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0)},
        {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 1, 0)},
        {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)},
        {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0)},
        {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(0, 1, 0)},
        {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
    }};
    for (std::size_t s = 0; s < sides.size(); ++s) {
        const auto& [corner, x, y] = sides[s];
        const Vec2 low(0.25 * static_cast<double>(s % 3), 0.25 * static_cast<double>(s / 3));
        model.add_quad(corner, corner + x, corner + x + y, corner + y,
                       [&, c = corner, u = x, v = y](const Vec3& p) {
                           return Vec2(low + 0.2 * Vec2((p - c).dot(u), (p - c).dot(v)));
                       });
    }
    PatternOptions options;
    options.mm_per_unit = 30.0;
    const Pattern pattern = pattern_of(model, options);
    ASSERT_EQ(pattern.pieces.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(pattern.pieces[i].name, "P0" + std::to_string(i + 1));
        EXPECT_NEAR(pattern.pieces[i].area, 900.0, 1e-6);
        EXPECT_EQ(pattern.pieces[i].outer.points.size(), 4u);
    }
    // The layout of the texture coordinates: three beside one another, a quarter apart.
    EXPECT_NEAR(pattern.width, 30.0 * 3.5, 1e-6);
    EXPECT_NEAR(pattern.height, 30.0 * 2.25, 1e-6);
}

TEST(Pieces, ManyPiecesGetLongerNames) {
    std::vector<Vec2> places;
    for (int i = 0; i < 120; ++i)
        places.emplace_back(2.0 * i, 0.0);
    const Pattern pattern = pattern_of(squares(places, flat));
    ASSERT_EQ(pattern.pieces.size(), 120u);
    EXPECT_EQ(pattern.pieces.front().name, "P001");
    EXPECT_EQ(pattern.pieces.back().name, "P120");
}

TEST(Pieces, SlitIsPartOfTheOutline) {
    // The sheet [0,2] × [0,1] with a slit from the right edge to the middle, slightly open.
    Model model;
    const auto lower = [](const Vec3& p) { return flat(p); };
    const auto upper = [](const Vec3& p) {
        return Vec2(p.x(), p.x() > 1.5 && p.y() == 1.0 ? 1.01 : p.y());
    };
    for (const double x : {0.0, 1.0})
        for (const double y : {0.0, 1.0})
            model.add_quad(Vec3(x, y, 0), Vec3(x + 1, y, 0), Vec3(x + 1, y + 1, 0),
                           Vec3(x, y + 1, 0), y > 0.5 ? upper : lower);
    const Pattern pattern = pattern_of(model);
    ASSERT_EQ(pattern.pieces.size(), 1u);
    EXPECT_EQ(pattern.pieces[0].outer.points.size(), 7u); // 4 around the sheet, 3 for the slit
    EXPECT_NEAR(length_of(pattern.pieces[0].outer.points), 10.0, 0.1);
}

TEST(Pieces, LayoutThatIsMirroredAsAWholeIsTurnedOver) {
    const Pattern straight = pattern_of(letter_l(Vec2::Zero(), flat));
    const Pattern mirrored =
        pattern_of(letter_l(Vec2::Zero(), [](const Vec3& p) { return Vec2(-p.x(), p.y()); }));
    ASSERT_EQ(mirrored.pieces.size(), 1u);
    EXPECT_GT(mirrored.pieces[0].outer.area, 0.0);
    expect_same_shape(straight.pieces[0], mirrored.pieces[0]);
}

TEST(Pieces, MirroredChartAmongOthersIsTurnedOverAndKeptClear) {
    for (const double distance : {2.5, 0.5}) { // boxes apart; boxes that overlap
        Model model = letter_l(Vec2::Zero(), flat);
        append(model, letter_l(Vec2(10, 0), flat));
        append(model, letter_l(Vec2(20, 0), [&](const Vec3& p) {
                   // Mirrored, and nestled into the first L for the small distance.
                   return Vec2(1.1 + distance + (22.0 - p.x()), p.y() + 1.1);
               }));
        const Pattern pattern = pattern_of(model);
        ASSERT_EQ(pattern.pieces.size(), 3u);
        expect_same_shape(pattern.pieces[0], pattern.pieces[1]);
        expect_same_shape(pattern.pieces[0], pattern.pieces[2]);
        EXPECT_TRUE(pattern.pieces[0].box.intersection(pattern.pieces[2].box).isEmpty());
    }
}

TEST(Pieces, HeightScalesAlongY) {
    PatternOptions options;
    options.height_mm = 250.0;
    options.mm_per_unit = 3.0; // ignored
    const Pattern pattern = pattern_of(letter_l(Vec2(5, 5), flat), options);
    EXPECT_NEAR(pattern.height, 250.0, 1e-9);
    EXPECT_NEAR(pattern.mm_per_unit, 125.0, 1e-9);

    Model lying = squares({Vec2(0, 0)}, [](const Vec3& p) { return Vec2(p.x(), -p.z()); });
    for (Vec3& p : lying.raw.points)
        p = Vec3(p.x(), 0.0, -p.y());
    lying.uv = {{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1)}, {Vec2(0, 0), Vec2(1, 1), Vec2(0, 1)}};
    const std::string found = message_of([&] { pattern_of(lying, options); });
    EXPECT_TRUE(contains(found, "height_mm")) << found;
}

TEST(Pieces, ScalesOutOfRangeAreRefused) {
    const Model model = letter_l(Vec2::Zero(), flat);
    for (const double bad :
         {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e-30, 1e30}) {
        PatternOptions options;
        options.mm_per_unit = bad;
        EXPECT_THROW(pattern_of(model, options), InvalidParameter) << bad;
    }
    for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e30}) {
        PatternOptions options;
        options.height_mm = bad;
        EXPECT_THROW(pattern_of(model, options), InvalidParameter) << bad;
    }
}

TEST(Pieces, CoordinatesThatMakeNoPiecesAreRefused) {
    const auto refusal = [](const std::function<Vec2(const Vec3&)>& place) {
        Model model = letter_l(Vec2::Zero(), place);
        EXPECT_THROW(pattern_of(model), InvalidMesh);
        return message_of([&] { pattern_of(model); });
    };
    const std::string zero = refusal([](const Vec3&) { return Vec2(0, 0); });
    EXPECT_TRUE(contains(zero, "at one point")) << zero;
    const std::string line = refusal([](const Vec3& p) { return Vec2(p.x(), 0.5); });
    EXPECT_TRUE(contains(line, "cover an area")) << line;
    const std::string nan =
        refusal([](const Vec3& p) { return Vec2(p.x() > 1.5 ? std::nan("") : p.x(), p.y()); });
    EXPECT_TRUE(contains(nan, "on 2 faces")) << nan;
    const std::string huge = refusal([](const Vec3& p) { return Vec2(1e300 * flat(p)); });
    EXPECT_TRUE(contains(huge, "too large")) << huge;
    for (const std::string& text : {zero, line, nan, huge})
        EXPECT_TRUE(contains(text, "'Charts: Flatten'")) << text;
}

TEST(Pieces, CollapsedChartsAreCountedAndNamed) {
    Model model = letter_l(Vec2::Zero(), flat);
    append(model, letter_l(Vec2(9, 0), [](const Vec3&) { return Vec2(5, 5); }));
    try {
        pattern_of(model);
        FAIL();
    } catch (const InvalidMesh& error) {
        EXPECT_TRUE(contains(error.what(), "1 of 2")) << error.what();
        EXPECT_EQ(error.faces.size(), 6u);
    }
}

// Atlases give charts of their own to faces without area, which no knife can cut out.
TEST(Pieces, NeedlesAreNoPieces) {
    Model model = letter_l(Vec2::Zero(), flat);
    model.add({0, 0, 0}, {0.5, -1e-9, 0}, {1, 0, 0},
              [](const Vec3& p) { return Vec2(flat(p) + Vec2(5, 5)); });
    const Pattern pattern = pattern_of(model);
    EXPECT_EQ(pattern.pieces.size(), 1u);
    ASSERT_EQ(pattern.notes.size(), 1u);
    EXPECT_TRUE(contains(pattern.notes.front(), "1 chart is narrower")) << pattern.notes.front();
}

TEST(Pieces, AClosedSurfaceWithoutSeamsFallsIntoFrontAndBack) {
    Model model;
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(0.3, 0.3, 1);
    for (const auto& [p, q, r] :
         {std::tie(a, c, b), std::tie(a, b, d), std::tie(b, c, d), std::tie(a, d, c)})
        model.add(p, q, r, flat);
    const Pattern pattern = pattern_of(model);
    EXPECT_EQ(pattern.pieces.size(), 2U);
    EXPECT_EQ(pattern.seams.size(), 3U);
}

TEST(Pieces, FoldsAreReported) {
    // The last square of the L is folded back onto the first one by little.
    const Model model = letter_l(
        Vec2::Zero(), [](const Vec3& p) { return Vec2(p.x() > 1.5 ? 0.95 : p.x(), p.y()); });
    const Pattern pattern = pattern_of(model);
    ASSERT_FALSE(pattern.notes.empty());
    EXPECT_TRUE(contains(pattern.notes[0], "1 of 1 pieces folds over")) << pattern.notes[0];
}

TEST(Pieces, WhatIsMirroredInTheTextureIsAPieceOfItsOwn) {
    // The last square of the L lies on the first one: the two sides of a model share a texture.
    const Model model = letter_l(
        Vec2::Zero(), [](const Vec3& p) { return Vec2(p.x() > 1.5 ? 0.0 : p.x(), p.y()); });
    PatternOptions options;
    options.mm_per_unit = 10.0;
    const Pattern pattern = pattern_of(model, options);
    ASSERT_EQ(pattern.pieces.size(), 2U);
    EXPECT_NEAR(pattern.pieces[0].area, 200.0, 1e-6);
    EXPECT_NEAR(pattern.pieces[1].area, 100.0, 1e-6);
    ASSERT_EQ(pattern.seams.size(), 1U);
    EXPECT_NEAR(pattern.seams[0].sides[0].length, 10.0, 1e-6);
    EXPECT_FALSE(pattern.pieces[0].box.intersects(pattern.pieces[1].box));
}

TEST(Pieces, IslandsAtOtherScalesAreBroughtToThatOfTheirOwnArea) {
    // Six strips in a row, one beside the other, each at a scale of its own in the texture.
    Model model;
    for (int i = 0; i < 6; ++i)
        append(model, letter_l(Vec2(3.0 * i, 0), [i](const Vec3& p) {
                   return Vec2((1.0 + 0.2 * i) * (flat(p) - Vec2(3.0 * i, 0)) + Vec2(5.0 * i, 0));
               }));
    PatternOptions options;
    options.mm_per_unit = 10.0;
    const Pattern pattern = pattern_of(model, options);
    ASSERT_EQ(pattern.pieces.size(), 6U);
    for (const PatternPiece& piece : pattern.pieces) {
        EXPECT_NEAR(piece.area, 300.0, 1e-6);
        EXPECT_NEAR(piece.long_side, pattern.pieces[0].long_side, 1e-6);
        for (const PatternPiece& other : pattern.pieces)
            if (&other != &piece) {
                EXPECT_FALSE(piece.box.intersects(other.box));
            }
    }
    ASSERT_EQ(pattern.notes.size(), 1U);
    EXPECT_TRUE(contains(pattern.notes[0], "not at one scale")) << pattern.notes[0];
}

TEST(Pieces, CancelIsHonoured) {
    const mesh::GatedMesh gated = mesh::gate_mesh(letter_l(Vec2::Zero(), flat).raw);
    const CornerUv uv(3 * gated.mesh.faces.size(), Vec2(0, 0));
    CornerUv spread = uv;
    for (std::size_t i = 0; i < spread.size(); ++i)
        spread[i] = Vec2(static_cast<double>(i % 3), static_cast<double>(i / 3 + i % 3 / 2));
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW(make_pattern(gated.mesh, spread, {}, progress), Cancelled);
}

} // namespace
} // namespace devseg::pattern
