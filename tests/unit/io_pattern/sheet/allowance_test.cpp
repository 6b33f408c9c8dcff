#include "sheet/allowance.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/plane/plane.h"
#include "sheet/export_options.h"

namespace devseg::sheet {
namespace {

using Ring = std::vector<Vec2>;

pattern::PatternPiece piece_of(const Ring& outer, const std::vector<Ring>& holes = {}) {
    pattern::PatternPiece piece;
    piece.outer.points = outer;
    for (const Vec2& p : outer)
        piece.box.extend(p);
    for (const Ring& hole : holes) {
        piece.holes.emplace_back();
        piece.holes.back().points = hole;
    }
    return piece;
}

double area(const Ring& ring) {
    double twice = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2& p = ring[i];
        const Vec2& q = ring[(i + 1) % ring.size()];
        twice += p.x() * q.y() - p.y() * q.x();
    }
    return 0.5 * twice;
}

double distance(const Ring& ring, const Vec2& p) {
    double least = 1e300;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2& a = ring[i];
        const Vec2 d = ring[(i + 1) % ring.size()] - a;
        const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
        least = std::min(least, (a + t * d - p).norm());
    }
    return least;
}

const Ring square = {Vec2(0, 0), Vec2(40, 0), Vec2(40, 40), Vec2(0, 40)};
const Ring corner = {Vec2(0, 0),   Vec2(40, 0),  Vec2(40, 20),
                     Vec2(20, 20), Vec2(20, 40), Vec2(0, 40)};

// Each side of a square is of another kind: so wide is its allowance.
TEST(Allowance, EachKindOfSeamHasItsOwn) {
    pattern::PatternPiece piece = piece_of(square);
    piece.outer.edges = {{3, 0, false}, {2, 0, false}, {5, 0, true}, {-1, 0, false}};
    ExportOptions options;
    options.seam_allowance_mm = 7.0;
    options.dart_allowance_mm = 3.0;
    options.hem_allowance_mm = 20.0;
    options.zip_allowance_mm = 12.0;
    options.zip_seams = "3,9";
    const Ring ring =
        add_allowance(piece, resolved(options).allowance(), CornerStyle::miter).front();
    EXPECT_NEAR(distance(ring, Vec2(20, 0)), 7.0, 1e-6);
    EXPECT_NEAR(distance(ring, Vec2(40, 20)), 12.0, 1e-6);
    EXPECT_NEAR(distance(ring, Vec2(20, 40)), 3.0, 1e-6);
    EXPECT_NEAR(distance(ring, Vec2(0, 20)), 20.0, 1e-6);
    for (const char* wrong : {"three", "0", "3,,4", ""}) {
        options.zip_seams = wrong;
        EXPECT_THROW(resolved(options).allowance(), InvalidParameter) << wrong;
    }
}

// Areas of a grown square are known in closed form for each kind of corner.
TEST(Allowance, CornersAreOfTheirStyle) {
    const double w = 5.0;
    const double straight = 1600.0 + 4.0 * 40.0 * w;
    const pattern::PatternPiece piece = piece_of(square);
    EXPECT_NEAR(area(add_allowance(piece, w, CornerStyle::miter)[0]), straight + 4 * w * w, 1e-3);
    EXPECT_NEAR(area(add_allowance(piece, w, CornerStyle::bevel)[0]), straight + 2 * w * w, 1e-3);
    EXPECT_NEAR(area(add_allowance(piece, w, CornerStyle::round)[0]), straight + M_PI * w * w, 0.4);
}

TEST(Allowance, ConcaveCornersAreTrimmed) {
    for (const CornerStyle style : {CornerStyle::miter, CornerStyle::bevel, CornerStyle::round}) {
        const std::vector<Ring> cut = add_allowance(piece_of(corner), 5.0, style);
        ASSERT_EQ(cut.size(), 1u);
        EXPECT_LT(distance({cut[0]}, Vec2(25, 25)), 1e-5);
        for (const Vec2& p : cut[0])
            EXPECT_GT(distance(corner, p), 5.0 * std::sqrt(0.5) - 1e-5);
    }
}

// A needle of 20 degrees: a pointed corner would reach 28 mm out.
TEST(Allowance, SharpCornersAreCutOff) {
    const Ring needle = {Vec2(0, 0), Vec2(100, -17.6), Vec2(100, 17.6)};
    const Ring cut = add_allowance(piece_of(needle), 5.0, CornerStyle::miter)[0];
    for (const Vec2& p : cut)
        EXPECT_LT(distance(needle, p), 10.0 + 1e-5);
}

TEST(Allowance, HolesShrinkAndSmallOnesClose) {
    const Ring wide = {Vec2(5, 5), Vec2(5, 35), Vec2(35, 35), Vec2(35, 5)};
    std::vector<Ring> cut = add_allowance(piece_of(square, {wide}), 4.0, CornerStyle::miter);
    ASSERT_EQ(cut.size(), 2u);
    EXPECT_NEAR(area(cut[1]), -22.0 * 22.0, 1e-3);
    const Ring narrow = {Vec2(18, 18), Vec2(18, 22), Vec2(22, 22), Vec2(22, 18)};
    EXPECT_EQ(add_allowance(piece_of(square, {narrow}), 4.0, CornerStyle::miter).size(), 1u);
}

// The allowances of a dart's two sides meet: the cut line runs straight over it.
TEST(Allowance, OpenHolesMayHaveNone) {
    const Ring hole = {Vec2(10, 10), Vec2(10, 30), Vec2(30, 30), Vec2(30, 10)};
    pattern::PatternPiece piece = piece_of(square, {hole});
    piece.outer.edges.assign(4, {});
    piece.holes.front().edges.assign(4, {});
    const AllowanceWidths widths(5.0, 3.0, 0.0);
    const std::vector<Ring> open = add_allowance(piece, widths, CornerStyle::miter);
    ASSERT_EQ(open.size(), 2U);
    EXPECT_NEAR(area(open[0]), 46.0 * 46.0, 1e-3);
    EXPECT_NEAR(area(open[1]), -400.0, 1e-3);
    // Its rim sewn to something, the allowance lies in the hole.
    piece.holes.front().edges.assign(4, {0, 0});
    EXPECT_NEAR(area(add_allowance(piece, widths, CornerStyle::miter)[1]), -100.0, 1e-3);
    EXPECT_EQ(ExportOptions().allowance().hole_hems, 0.0);
}

TEST(Allowance, NarrowDartsAreCovered) {
    const Ring dart = {Vec2(0, 0),  Vec2(40, 0),  Vec2(40, 40), Vec2(22, 40),
                       Vec2(20, 5), Vec2(18, 40), Vec2(0, 40)};
    const std::vector<Ring> cut = add_allowance(piece_of(dart), 5.0, CornerStyle::miter);
    ASSERT_EQ(cut.size(), 1u);
    EXPECT_TRUE(plane::is_inside(cut, Vec2(20, 20)));
    for (const Vec2& p : cut[0])
        EXPECT_FALSE(p.y() > 0.0 && p.y() < 38.0 && p.x() > 0.0 && p.x() < 40.0);
}

// The lower side of the square is a hem, twice as wide as the seams.
TEST(Allowance, HemsHaveAWidthOfTheirOwn) {
    pattern::PatternPiece piece = piece_of(square);
    piece.outer.edges.assign(4, {0, 0});
    piece.outer.edges[0].seam = -1;
    const Ring cut = add_allowance(piece, {5.0, 10.0}, CornerStyle::miter)[0];
    EXPECT_NEAR(area(cut), (40.0 + 2 * 5.0) * (40.0 + 5.0 + 10.0), 1e-3);
    EXPECT_NEAR(distance(cut, Vec2(20, 0)), 10.0, 1e-5);
    EXPECT_NEAR(distance(cut, Vec2(20, 40)), 5.0, 1e-5);
    // No hem, and nothing but the hem: both end where the sides of the square meet their lines.
    EXPECT_NEAR(area(add_allowance(piece, {5.0, 0.0}, CornerStyle::miter)[0]), 50.0 * 45.0, 1e-3);
    EXPECT_NEAR(area(add_allowance(piece, {0.0, 10.0}, CornerStyle::miter)[0]), 40.0 * 50.0, 1e-3);
    for (const CornerStyle style : {CornerStyle::bevel, CornerStyle::round}) {
        const double all = area(add_allowance(piece, {5.0, 10.0}, style)[0]);
        EXPECT_LT(all, 50.0 * 55.0);
        EXPECT_GT(all, 50.0 * 55.0 - 2 * 50.0 - 2 * 25.0);
    }
}

// Where a hem goes on straight as a seam, the cut line steps.
TEST(Allowance, StepsOnStraightOutlines) {
    pattern::PatternPiece piece =
        piece_of({Vec2(0, 0), Vec2(20, 0), Vec2(40, 0), Vec2(40, 40), Vec2(0, 40)});
    piece.outer.edges.assign(5, {0, 0});
    piece.outer.edges[0].seam = -1;
    const Ring cut = add_allowance(piece, {5.0, 12.0}, CornerStyle::miter)[0];
    EXPECT_NEAR(area(cut), 50.0 * 50.0 + 25.0 * 7.0, 1e-3);
}

} // namespace
} // namespace devseg::sheet
