// Pieces that are nearly alike become alike.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/pattern/alike.h"
#include "devseg/pattern/outlines.h"
#include "devseg/pattern/same_pieces.h"
#include "unit/mesh_edits.h"

namespace devseg::pattern {
namespace {

using Ring = std::vector<Vec2>;

// A petal of 100 by 60 mm with a narrow dart from its upper side, as `count` points; `wave` mm bend
// it three times around. One half is longer, so that it is not its own mirror image.
Ring petal(int count, double wave, double longer = 10.0) {
    Ring ring;
    bool has_dart = false;
    for (int i = 0; i < count; ++i) {
        const double t = 2.0 * pi * i / count;
        const double r = 1.0 + wave / 50.0 * std::sin(3.0 * t + 0.4);
        const double x = 50.0 * std::cos(t);
        if (x < 0.0 && !has_dart) { // 2 mm wide, 20 mm deep
            for (const Vec2& p : {Vec2(1.0, 30.0), Vec2(0.0, 10.0), Vec2(-1.0, 30.0)})
                ring.push_back(p);
            has_dart = true;
        }
        if (std::sin(t) < 0.0 || std::abs(x) > 1.5)
            ring.emplace_back(r * (x + (x > 0.0 ? longer * x / 50.0 : 0.0)),
                              r * 30.0 * std::sin(t));
    }
    return ring;
}

PatternPiece piece_of(Ring ring, double angle, const Vec2& shift, bool mirrored) {
    for (Vec2& p : ring) {
        if (mirrored)
            p.x() = -p.x();
        p = Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                 std::sin(angle) * p.x() + std::cos(angle) * p.y()) +
            shift;
    }
    if (mirrored)
        std::reverse(ring.begin(), ring.end());
    PatternPiece piece;
    piece.outer.points = std::move(ring);
    measure_outlines(piece);
    return piece;
}

std::vector<PatternPiece> nearly_mirrored() {
    return {piece_of(petal(80, 0.5), 0.3, Vec2(0.0, 0.0), false),
            piece_of(petal(113, -0.5), 2.0, Vec2(200.0, 40.0), true)};
}

bool are_a_pair(std::vector<PatternPiece> pieces, double tolerance) {
    for (PatternPiece& piece : pieces)
        measure_outlines(piece);
    find_same_pieces(pieces, tolerance, Progress());
    return pieces[0].quantity == 1 && pieces[0].mirrored_quantity == 1 && pieces[1].mirrored;
}

// How far the tip of the dart, the nearest point to the middle, is from the middle of the petal.
double depth_of_dart(const PatternPiece& piece, const Vec2& middle) {
    double least = infinite;
    for (const Vec2& p : piece.outer.points)
        least = std::min(least, (p - middle).norm());
    return least;
}

// Stars of random rays: no two of one shape, but for noise, unless one is a copy of the other.
Ring star(shapes::Random& random) {
    Ring ring;
    for (int i = 0; i < 14; ++i)
        ring.push_back(random.uniform(10.0, 40.0) *
                       Vec2(std::cos(2.0 * pi * i / 14.0), std::sin(2.0 * pi * i / 14.0)));
    return ring;
}

TEST(SamePieces, CopiesAreFoundAmongManyOthers) {
    shapes::Random random(5);
    const std::size_t count = 150;
    std::vector<PatternPiece> pieces;
    std::vector<Ring> rings;
    for (std::size_t i = 0; i < count; ++i) {
        rings.push_back(star(random));
        pieces.push_back(piece_of(rings.back(), 0.0, Vec2(0.0, 0.0), false));
    }
    for (std::size_t i = count; i-- > 0;) { // ragged by less than the tolerance
        for (Vec2& p : rings[i])
            p += Vec2(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02));
        pieces.push_back(piece_of(rings[i], random.uniform(0.0, 6.0), Vec2(50.0, 9.0), i % 2 == 1));
    }
    find_same_pieces(pieces, 0.1, Progress());
    for (std::size_t i = 0; i < count; ++i) {
        EXPECT_EQ(pieces[i].quantity + pieces[i].mirrored_quantity, 2) << i;
        const PatternPiece& copy = pieces[2 * count - 1 - i];
        EXPECT_EQ(copy.model, static_cast<Index>(i));
        EXPECT_EQ(copy.mirrored, i % 2 == 1);
    }
}

TEST(Alike, MirroredPiecesGetTheMeanOfTheirOutlines) {
    std::vector<PatternPiece> pieces = nearly_mirrored();
    ASSERT_FALSE(are_a_pair(pieces, 0.3));
    const double area = 0.5 * (pieces[0].area + pieces[1].area);
    EXPECT_EQ(make_alike(pieces, 2.0, Progress()), 2);
    EXPECT_TRUE(are_a_pair(pieces, 0.3));
    for (PatternPiece& piece : pieces) {
        measure_outlines(piece);
        EXPECT_NEAR(piece.area, area, 0.002 * area);
    }
    // The dart keeps its legs apart, and its tip.
    EXPECT_NEAR(depth_of_dart(pieces[0], Vec2(0.0, 0.0)), 10.0, 0.5);
    EXPECT_NEAR(depth_of_dart(pieces[1], Vec2(200.0, 40.0)), 10.0, 0.5);
}

TEST(Alike, PiecesThatDifferByMoreStay) {
    std::vector<PatternPiece> pieces = nearly_mirrored();
    const std::vector<PatternPiece> before = pieces;
    EXPECT_EQ(make_alike(pieces, 0.4, Progress()), 0);
    for (std::size_t i = 0; i < pieces.size(); ++i)
        EXPECT_EQ(pieces[i].outer.points, before[i].outer.points);
}

TEST(Alike, APieceNearToItsOwnImageBecomesSymmetric) {
    std::vector<PatternPiece> pieces{piece_of(petal(97, 0.4, 0.5), 1.0, Vec2(5.0, 7.0), false)};
    ASSERT_FALSE(find_mirror_axis(pieces[0], 0.3));
    EXPECT_EQ(make_alike(pieces, 2.0, Progress()), 1);
    measure_outlines(pieces[0]);
    EXPECT_TRUE(find_mirror_axis(pieces[0], 0.3));
}

TEST(Alike, HolesFollowTheirPieces) {
    std::vector<PatternPiece> pieces = nearly_mirrored();
    const auto add_hole = [](PatternPiece& piece, double angle, const Vec2& shift, bool mirrored,
                             double radius) {
        Ring ring;
        for (int i = 0; i < 24; ++i) // clockwise
            ring.emplace_back(-25.0 + radius * std::cos(-2.0 * pi * i / 24.0),
                              radius * std::sin(-2.0 * pi * i / 24.0));
        const PatternPiece hole = piece_of(ring, angle, shift, mirrored);
        piece.holes.push_back(hole.outer);
        measure_outlines(piece);
    };
    add_hole(pieces[0], 0.3, Vec2(0.0, 0.0), false, 8.0);
    add_hole(pieces[1], 2.0, Vec2(200.0, 40.0), true, 9.0);
    EXPECT_EQ(make_alike(pieces, 2.0, Progress()), 2);
    measure_outlines(pieces[0]);
    measure_outlines(pieces[1]);
    EXPECT_NEAR(pieces[0].holes[0].area, pieces[1].holes[0].area, 1.0);
    EXPECT_TRUE(are_a_pair(pieces, 0.3));
}

} // namespace
} // namespace devseg::pattern
