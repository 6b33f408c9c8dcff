// Seams, notches, outlines and shapes of patterns.
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "devseg/pattern/inside.h"
#include "devseg/pattern/match.h"
#include "devseg/pattern/outlines.h"
#include "devseg/pattern/seams.h"
#include "devseg/pattern/shapes.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/pattern_samples.h"
#include "unit/shapes.h"

namespace devseg::pattern {
namespace {

using samples::Cloth;
using samples::flat;

double length_of(const Pattern& pattern, const SeamSide& side) {
    double length = 0.0;
    for (Index k = 0; k < side.count; ++k)
        length +=
            (side_point(pattern.pieces, side, k + 1) - side_point(pattern.pieces, side, k)).norm();
    return length;
}

// Every edge of every outline is in one side of one seam, or on the boundary of the model.
void expect_every_side_once(const Pattern& pattern) {
    std::multiset<std::array<Index, 3>> covered; // piece, path, edge
    for (std::size_t i = 0; i < pattern.seams.size(); ++i) {
        const Seam& seam = pattern.seams[i];
        EXPECT_EQ(seam.number, static_cast<Index>(i) + 1);
        for (std::size_t s = 0; s < 2; ++s) {
            const SeamSide& side = seam.sides[s];
            EXPECT_EQ(side.reversed, s == 1);
            EXPECT_NEAR(side.length, length_of(pattern, side), 1e-9);
            const PiecePath& path = pattern.pieces[side.piece].path(side.path);
            for (Index e = 0; e < side.count; ++e) {
                const std::size_t edge = at(side.first + e) % path.points.size();
                EXPECT_EQ(path.edges[edge].seam, static_cast<Index>(i));
                EXPECT_EQ(path.edges[edge].side, static_cast<int>(s));
                covered.insert({side.piece, side.path, static_cast<Index>(edge)});
            }
        }
    }
    for (std::size_t p = 0; p < pattern.pieces.size(); ++p)
        for (Index l = 0; l < pattern.pieces[p].path_count(); ++l) {
            const PiecePath& path = pattern.pieces[p].path(l);
            ASSERT_EQ(path.edges.size(), path.points.size());
            ASSERT_EQ(path.corner.size(), path.points.size());
            ASSERT_EQ(path.half_edge.size(), path.points.size());
            for (std::size_t e = 0; e < path.edges.size(); ++e)
                EXPECT_EQ(covered.count({static_cast<Index>(p), l, static_cast<Index>(e)}),
                          path.edges[e].seam >= 0 ? 1U : 0U);
        }
}

// A letter of unit squares that no mirror or turn maps to itself.
mesh::RawMesh letter() {
    return shapes::plate({"####", "#...", "##.."});
}

Cloth::Place moved(const Vec2& offset, double angle = 0.0, bool mirrored = false) {
    return [=](const Vec3& p, const Vec3&) {
        const Vec2 q(mirrored ? -p.x() : p.x(), p.y());
        return Vec2(Eigen::Rotation2Dd(angle) * q + offset);
    };
}

TEST(Seams, TwoPiecesShareOneSeam) {
    const Pattern pattern = samples::two_pieces().pattern();
    ASSERT_EQ(pattern.pieces.size(), 2U);
    ASSERT_EQ(pattern.seams.size(), 1U);
    const Seam& seam = pattern.seams[0];
    EXPECT_EQ(seam.label, "1");
    EXPECT_NE(seam.sides[0].piece, seam.sides[1].piece);
    EXPECT_NEAR(seam.sides[0].length, 80.0, 1e-6);
    EXPECT_NEAR(seam.surface_length, 80.0, 1e-6);
    EXPECT_NEAR(seam.mismatch(), 0.0, 1e-6);
    EXPECT_FALSE(seam.is_dart);
    // Both start at the same end: the same height on the sheet.
    for (Index k = 0; k <= seam.sides[0].count; ++k)
        EXPECT_NEAR(side_point(pattern.pieces, seam.sides[0], k).y(),
                    side_point(pattern.pieces, seam.sides[1], k).y(), 1e-6);
    expect_every_side_once(pattern);
}

TEST(Seams, DartIsASeamOfAPieceWithItselfAndEndsAtItsTip) {
    const Pattern pattern = samples::with_dart(20.0).pattern();
    ASSERT_EQ(pattern.pieces.size(), 1U);
    ASSERT_EQ(pattern.seams.size(), 1U);
    const Seam& dart = pattern.seams[0];
    EXPECT_TRUE(dart.is_dart);
    const auto end = [&](std::size_t s) {
        return side_point(pattern.pieces, dart.sides[s], dart.sides[s].count);
    };
    EXPECT_EQ(end(0), end(1));
    EXPECT_GT((side_point(pattern.pieces, dart.sides[0], 0) -
               side_point(pattern.pieces, dart.sides[1], 0))
                  .norm(),
              10.0);
    expect_every_side_once(pattern);
}

TEST(Seams, EverySideOfFlattenedChartsIsInOneSeam) {
    for (const char* method : {"tetrahedron", "double torus"}) {
        declare::HostMesh host =
            checks::host_of(method[0] == 't' ? shapes::tetrahedron() : shapes::double_torus());
        const declare::HostResult charts = checks::run("Segmentation: D-Charts", host,
                                                       {{"charts_number", method[0] == 't' ? 4 : 6},
                                                        {"merge_charts", false},
                                                        {"straighten_boundaries", false}});
        checks::take_charts(host, charts);
        host.wedge_uv = checks::run("Charts: Flatten", host, {{"method", 4}}).wedge_uv;
        const mesh::GatedMesh gated = mesh::gate_mesh(host.geometry);
        CornerUv uv;
        for (const Face f : gated.mesh.all_faces())
            for (Index k = 0; k < 3; ++k)
                uv.push_back(host.wedge_uv[gated.source_face[f]][gated.source_corner(f, k)]);
        PatternOptions options;
        options.mm_per_unit = 50.0;
        Progress progress;
        const Pattern pattern = make_pattern(gated.mesh, uv, options, progress);
        EXPECT_GE(pattern.seams.size(), 6U) << method;
        expect_every_side_once(pattern);
        for (const Seam& seam : pattern.seams)
            EXPECT_TRUE(sides_agree(seam.sides[0].length, seam.sides[1].length)) << seam.label;
    }
}

TEST(Seams, SidesOfUnequalLengthAreMatched) {
    Cloth cloth;
    const auto place = [](const Vec3& p, const Vec3& middle) {
        // The right piece is 5 % higher than the left one, and both have their area.
        const double stretch = std::pow(1.05, middle.x() > 40.0 ? 0.5 : -0.5);
        return Vec2(p.x() / stretch + (middle.x() > 40.0 ? 7.0 : 0.0), stretch * p.y());
    };
    cloth.add(shapes::grid(8, 8, 80.0, 80.0), place);
    PatternOptions options;
    options.match_seams = false;
    const Pattern before = cloth.pattern(options);
    EXPECT_NEAR(std::abs(before.seams[0].mismatch_percent()), 4.88, 0.05);
    ASSERT_FALSE(before.notes.empty());
    EXPECT_TRUE(checks::contains(before.notes.back(), "LPFB"));
    const Pattern after = cloth.pattern();
    EXPECT_NEAR(after.seams[0].mismatch(), 0.0, 1e-6);
    // Neither side is as long as on the model: both meet in the middle.
    const double middle = 0.5 * (before.seams[0].sides[0].length + before.seams[0].sides[1].length);
    EXPECT_NEAR(after.seams[0].sides[0].length, middle, 1e-6);
}

TEST(Seams, ASideThatIsTrueKeepsItsLength) {
    Cloth cloth;
    // A long piece that is true decides the scale; the short one at its end is stretched.
    cloth.add(shapes::grid(40, 8, 4000.0, 80.0), [](const Vec3& p, const Vec3& middle) {
        const bool stretched = middle.x() > 3900.0;
        return Vec2(p.x() + (stretched ? 5.0 : 0.0), (stretched ? 1.05 : 1.0) * p.y());
    });
    const Pattern pattern = cloth.pattern();
    ASSERT_EQ(pattern.seams.size(), 1U);
    EXPECT_NEAR(pattern.seams[0].mismatch(), 0.0, 1e-6);
    EXPECT_NEAR(pattern.seams[0].sides[0].length, 80.0, 0.01);
}

TEST(Notches, LieAtTheSameShareOnBothSidesAndFitOneWayOnly) {
    PatternOptions options;
    for (const double spacing : {7.0, 20.0, 30.0, 60.0, 79.0}) {
        options.notch_spacing_mm = spacing;
        const Pattern pattern = samples::two_pieces().pattern(options);
        const Seam& seam = pattern.seams[0];
        const std::vector<double>& notches = seam.sides[0].notches;
        ASSERT_EQ(notches.size(), std::max(1.0, std::round(80.0 / spacing)));
        ASSERT_EQ(seam.sides[1].notches.size(), notches.size());
        double worst = 0.0;
        for (std::size_t i = 0; i < notches.size(); ++i) {
            EXPECT_NEAR(notches[i], seam.sides[1].notches[i], 1e-6);
            EXPECT_GT(notches[i], 0.01 * 80.0);
            EXPECT_LT(notches[i], 0.99 * 80.0);
            // The other way round, some notch is far from all others.
            double nearest = 80.0;
            for (const double other : notches)
                nearest = std::min(nearest, std::abs(80.0 - notches[i] - other));
            worst = std::max(worst, nearest);
        }
        EXPECT_GT(worst, 0.1 * spacing) << spacing;
    }
    options.notch_spacing_mm = 0.0;
    EXPECT_TRUE(samples::two_pieces().pattern(options).seams[0].sides[0].notches.empty());
}

// A jog in the middle of the seam, where the only notch would be.
TEST(Notches, KeepAwayFromSharpBends) {
    Pattern pattern;
    pattern.pieces.resize(2);
    const std::vector<Vec2> bent{{0, 0}, {40, 0}, {40, 3}, {80, 3}};
    for (const std::size_t p : {std::size_t{0}, std::size_t{1}})
        pattern.pieces[p].outer.points = bent;
    Seam seam;
    seam.number = 1;
    for (const Index p : {0, 1})
        seam.sides[p] = {p, 0, 0, 3, false, 83.0, {}};
    pattern.seams = {seam};
    for (const double spacing : {20.0, 60.0}) {
        set_notches(pattern, spacing);
        for (const SeamSide& side : pattern.seams[0].sides)
            for (const double notch : side.notches)
                EXPECT_TRUE(notch < 38.0 || notch > 45.0) << spacing << ' ' << notch;
    }
}

TEST(Notches, PointOnSideIsOnTheOutlineAndLooksOut) {
    const Pattern pattern = samples::two_pieces().pattern();
    const Seam& seam = pattern.seams[0];
    for (const SeamSide& side : seam.sides) {
        const SidePoint place = point_on_side(pattern.pieces, side, 30.0);
        const Vec2 start = side_point(pattern.pieces, side, 0);
        EXPECT_NEAR((place.position - start).norm(), 30.0, 1e-6);
        const PatternPiece& piece = pattern.pieces[side.piece];
        const Vec2 out = place.position + 2.0 * place.outward;
        const Vec2 in = place.position - 2.0 * place.outward;
        EXPECT_FALSE(piece.box.contains(out));
        EXPECT_TRUE(piece.box.contains(in));
    }
}

TEST(Shapes, MirroredAndEqualPiecesAreFound) {
    Cloth cloth;
    cloth.add(letter(), moved(Vec2(0, 0)));
    cloth.add(letter(), moved(Vec2(20, 0), 2.1));
    cloth.add(shapes::plate({"####", "#...", "###."}), moved(Vec2(40, 0)));
    // The mirror image on the model, not only in the texture.
    mesh::RawMesh mirrored = letter();
    for (Vec3& p : mirrored.points)
        p.x() = -p.x();
    for (Triangle& t : mirrored.faces)
        std::swap(t[1], t[2]);
    cloth.add(mirrored, moved(Vec2(60, 0), -0.7));
    PatternOptions options;
    options.mm_per_unit = 10.0;
    const Pattern pattern = cloth.pattern(options);
    ASSERT_EQ(pattern.pieces.size(), 4U);
    const auto& p = pattern.pieces;
    EXPECT_EQ(p[0].model, 0);
    EXPECT_EQ(p[0].quantity, 2);
    EXPECT_EQ(p[0].mirrored_quantity, 1);
    EXPECT_EQ(p[1].model, 0);
    EXPECT_FALSE(p[1].mirrored);
    EXPECT_EQ(p[1].quantity, 0);
    EXPECT_EQ(p[2].model, 2);
    EXPECT_EQ(p[2].quantity, 1);
    EXPECT_EQ(p[3].model, 0);
    EXPECT_TRUE(p[3].mirrored);
}

TEST(Shapes, ToleranceDecidesWhatIsEqual) {
    Cloth cloth;
    cloth.add(shapes::grid(2, 1, 100.0, 50.0), moved(Vec2(0, 0)));
    cloth.add(shapes::grid(2, 1, 100.4, 50.0), moved(Vec2(200, 0)));
    PatternOptions options;
    options.pair_tolerance_mm = 0.5;
    EXPECT_EQ(cloth.pattern(options).pieces[1].model, 0);
    options.pair_tolerance_mm = 0.1;
    EXPECT_EQ(cloth.pattern(options).pieces[1].model, 1);
}

TEST(Shapes, GrainLineFollowsTheLongSideOrTheTexture) {
    Cloth cloth;
    cloth.add(shapes::grid(4, 1, 100.0, 20.0), moved(Vec2(0, 0), 0.5));
    PatternOptions options;
    const PatternPiece longest = cloth.pattern(options).pieces[0];
    const Vec2 along = (longest.grain[1] - longest.grain[0]).normalized();
    EXPECT_NEAR(along.dot(Vec2(std::cos(0.5), std::sin(0.5))), 1.0, 1e-6);
    EXPECT_NEAR(longest.long_side, 100.0, 1e-4);
    EXPECT_NEAR(longest.short_side, 20.0, 1e-4);
    const double length = (longest.grain[1] - longest.grain[0]).norm();
    EXPECT_GT(length, 60.0);
    EXPECT_LT(length, 100.0);
    options.grain = GrainDirection::texture_v;
    const PatternPiece upright = cloth.pattern(options).pieces[0];
    EXPECT_NEAR((upright.grain[1] - upright.grain[0]).normalized().y(), 1.0, 1e-9);
}

TEST(Shapes, LargePiecesAreSplitAcrossTheirLongSideAlongAStraightLine) {
    Cloth cloth;
    cloth.add(shapes::grid(60, 4, 300.0, 20.0), moved(Vec2(0, 0)));
    PatternOptions options;
    options.max_piece_mm = 110.0;
    const Pattern pattern = cloth.pattern(options);
    ASSERT_EQ(pattern.pieces.size(), 3U);
    ASSERT_EQ(pattern.seams.size(), 2U);
    double area = 0.0;
    for (const PatternPiece& piece : pattern.pieces) {
        EXPECT_LE(piece.long_side, 110.0);
        area += piece.area;
    }
    EXPECT_NEAR(area, 6000.0, 1e-6);
    for (const Seam& seam : pattern.seams) {
        EXPECT_EQ(seam.sides[0].count, 1);
        EXPECT_NEAR(seam.sides[0].length, 20.0, 2.0);
        EXPECT_NEAR(seam.mismatch(), 0.0, 1e-9);
    }
    for (const Index p : pattern.face_piece)
        EXPECT_GE(p, 0);
    EXPECT_TRUE(overlapping_pieces(pattern.pieces).empty());
    expect_every_side_once(pattern);
}

// A tube of quads as high as the tube, in two charts that are too high.
TEST(Shapes, FacesAreCutWhereTheyAreLongerThanPieces) {
    Cloth cloth;
    const mesh::RawMesh tube = shapes::cylinder_tube(24, 1, 50.0, 200.0);
    cloth.add(tube, [](const Vec3& p, const Vec3& middle) {
        const double turn = std::atan2(middle.y(), middle.x());
        const double own = turn + std::remainder(std::atan2(p.y(), p.x()) - turn, 2.0 * pi);
        const double side = 2.0 * 50.0 * std::sin(pi / 24.0); // of the polygon that the tube is
        return Vec2(own * 24.0 / (2.0 * pi) * side + (turn > 0.0 ? 20.0 : 0.0), p.z());
    });
    const Pattern whole = cloth.pattern();
    ASSERT_EQ(whole.pieces.size(), 2U);
    PatternOptions options;
    options.max_piece_mm = 160.0;
    const Pattern pattern = cloth.pattern(options);
    ASSERT_EQ(pattern.pieces.size(), 4U);
    double area = 0.0;
    for (const PatternPiece& piece : pattern.pieces) {
        EXPECT_LE(piece.long_side, 160.0);
        EXPECT_NEAR(piece.box.sizes().minCoeff(), 100.0, 1e-6);
        area += piece.area;
    }
    EXPECT_NEAR(area, whole.pieces[0].area + whole.pieces[1].area, 1e-6);
    EXPECT_EQ(pattern.seams.size(), whole.seams.size() + 4U); // two cuts, two seams cut in two
    for (const Seam& seam : pattern.seams)
        EXPECT_NEAR(seam.mismatch(), 0.0, 1e-9);
    EXPECT_TRUE(overlapping_pieces(pattern.pieces).empty());
    expect_every_side_once(pattern);
    // The mesh with its new vertices is one as the core has it, and knows where its faces are from.
    EXPECT_TRUE(checks::is_valid(pattern.mesh));
    EXPECT_NEAR(pattern.mesh.total_area, cloth.mesh().total_area, 1e-9);
    ASSERT_EQ(pattern.source_face.size(), pattern.mesh.faces.size());
    for (std::size_t f = 0; f < pattern.source_face.size(); ++f)
        EXPECT_NEAR(
            pattern.mesh.face_normals[f].dot(cloth.mesh().face_normals[pattern.source_face[f]]),
            1.0, 1e-9);
    options.max_piece_mm = 0.5;
    EXPECT_TRUE(checks::contains(
        checks::error_of<InvalidParameter>([&] { cloth.pattern(options); }), "at most 1000 cuts"));
}

TEST(Shapes, NoLimitMakesMorePiecesThatAreNoShorter) {
    Cloth cloth;
    cloth.add(shapes::grid(5, 1, 10.0, 200.0), moved(Vec2(0, 0)));
    PatternOptions options;
    for (const double limit : {150.0, 90.0, 41.0, 7.0}) {
        options.max_piece_mm = limit;
        const Pattern pattern = cloth.pattern(options);
        EXPECT_LE(pattern.pieces.size(), std::ceil(200.1 / limit) * std::ceil(10.0 / limit));
        for (const PatternPiece& piece : pattern.pieces)
            EXPECT_LE(piece.long_side, limit * (1.0 + 1e-5));
    }
}

TEST(Shapes, StackedPiecesGetPlacesOfTheirOwn) {
    Cloth cloth;
    for (int i = 0; i < 3; ++i)
        cloth.add(shapes::grid(2, 2, 10.0, 10.0), moved(Vec2(i == 2 ? 4.0 : 0.0, 0.0)));
    const Pattern pattern = cloth.pattern();
    ASSERT_EQ(pattern.pieces.size(), 3U);
    EXPECT_TRUE(overlapping_pieces(pattern.pieces).empty());
    for (const PatternPiece& piece : pattern.pieces) {
        EXPECT_GE(piece.box.min().minCoeff(), -1e-9);
        EXPECT_LE(piece.box.max().y(), pattern.height + 1e-9);
    }
    ASSERT_FALSE(pattern.notes.empty());
    EXPECT_TRUE(checks::contains(pattern.notes.front(), "2 of 3 pieces lie on others"));
}

// The right half is too low in the texture: where its side of the seam gets its length, it comes to
// lie on the patch above it.
TEST(Shapes, PiecesThatSidesOfEqualLengthPushOnOthersArePartedWithoutAWord) {
    Cloth cloth;
    cloth.add(shapes::grid(8, 8, 80.0, 80.0), [](const Vec3& p, const Vec3& middle) {
        return middle.x() > 40.0 ? Vec2(60.0 + p.x() / 0.98, 0.98 * p.y()) : flat(p);
    });
    cloth.add(shapes::grid(2, 2, 10.0, 10.0), moved(Vec2(110.0, 78.5)));
    const Pattern pattern = cloth.pattern();
    ASSERT_EQ(pattern.pieces.size(), 3U);
    EXPECT_TRUE(overlapping_pieces(pattern.pieces).empty());
    // The layout has been drawn out; the patch has not gone above all others.
    EXPECT_GT(pattern.height, 88.6);
    EXPECT_LT(pattern.height, 92.0);
    EXPECT_TRUE(pattern.notes.empty()) << pattern.notes.front();
}

// A square whose outline was moved by a linear map: mean value coordinates repeat it inside.
TEST(MatchedMap, FollowsLinearMovesOfTheOutline) {
    const Mesh mesh = mesh::gate_mesh(shapes::grid(6, 6, 10.0, 10.0)).mesh;
    CornerUv uv;
    for (const Triangle& t : mesh.faces)
        for (const Index v : t)
            uv.push_back(mesh.points[v].head<2>());
    Eigen::Matrix2d map;
    map << 1.1, 0.05, -0.02, 0.9;
    PatternPiece piece;
    std::vector<Index> faces;
    for (const Face f : mesh.all_faces()) {
        faces.push_back(f);
        for (const HalfEdge h : half_edges_of(f))
            if (mesh.twin[h] < 0)
                piece.outer.half_edge.push_back(h);
    }
    // Around the square.
    std::vector<Index>& ring = piece.outer.half_edge;
    for (std::size_t i = 0; i + 1 < ring.size(); ++i)
        for (std::size_t k = i + 1; k < ring.size(); ++k)
            if (mesh.origin(ring[k]) == mesh.origin(Mesh::next(ring[i])))
                std::swap(ring[i + 1], ring[k]);
    for (const Index h : ring)
        piece.outer.points.push_back(map * uv[h] + Vec2(3, 4));
    for (const Vec2& p : piece.outer.points)
        piece.box.extend(p);
    const std::vector<Vec2> moved = place_corners(mesh, uv, faces, piece);
    for (std::size_t i = 0; i < uv.size(); ++i)
        EXPECT_LT((moved[i] - map * uv[i] - Vec2(3, 4)).norm(), 1e-9);
}

TEST(MatchedMap, IsThatOfTheSheetInsideMatchedPieces) {
    Cloth cloth;
    cloth.add(shapes::grid(8, 8, 80.0, 80.0), [](const Vec3& p, const Vec3& middle) {
        return Vec2(p.x() + (middle.x() > 40.0 ? 5.0 : 0.0),
                    (middle.x() > 40.0 ? 1.05 : 1.0) * p.y());
    });
    const Pattern pattern = cloth.pattern();
    const Mesh mesh = cloth.mesh();
    for (const PatternPiece& piece : pattern.pieces) {
        Eigen::AlignedBox2d box;
        for (std::size_t i = 0; i < pattern.corner_place.size(); ++i)
            if (&pattern.pieces[pattern.face_piece[i / 3]] == &piece)
                box.extend(pattern.corner_place[i]);
        EXPECT_LT((box.min() - piece.box.min()).norm(), 1e-6);
        EXPECT_LT((box.max() - piece.box.max()).norm(), 1e-6);
    }
}

TEST(Shapes, StrainIsThatOfTheLinesInTheMaterial) {
    Cloth cloth;
    cloth.add(shapes::grid(4, 4, 100.0, 100.0),
              [](const Vec3& p, const Vec3&) { return Vec2(1.21 * p.x(), p.y()); });
    const PatternPiece piece = cloth.pattern().pieces[0];
    // The scale of a single chart keeps the length of its boundary.
    const double scale = 0.5 * (1.21 + 1.0);
    EXPECT_NEAR(piece.strain.extension, 1.21 / scale - 1.0, 1e-6);
    EXPECT_NEAR(piece.strain.compression, 1.0 - 1.0 / scale, 1e-6);
    EXPECT_NEAR(piece.strain.mean, 1.21 / scale - 1.0, 1e-6);
    EXPECT_NEAR(piece.strain.area_change, 1.21 / (scale * scale) - 1.0, 1e-6);
    EXPECT_GE(piece.strain.worst_face, 0);
}

TEST(Shapes, OptionsOutOfRangeAreRefused) {
    for (double PatternOptions::*field :
         {&PatternOptions::simplify_mm, &PatternOptions::corner_angle, &PatternOptions::curve_mm,
          &PatternOptions::notch_spacing_mm, &PatternOptions::fold_angle,
          &PatternOptions::max_piece_mm, &PatternOptions::max_width_mm,
          &PatternOptions::pair_tolerance_mm, &PatternOptions::alike_mm})
        for (const double bad : {-1.0, std::nan("")}) {
            PatternOptions options;
            options.*field = bad;
            EXPECT_THROW(samples::two_pieces().pattern(options), InvalidParameter);
        }
}

TEST(Shapes, FoldsHaveTheAngleBetweenTheirFaces) {
    for (const double sign : {1.0, -1.0}) {
        Cloth cloth;
        mesh::RawMesh bent = shapes::grid(2, 1, 20.0, 10.0);
        const double angle = 40.0 * shapes::pi / 180.0;
        for (Vec3& p : bent.points)
            if (p.x() > 15.0)
                p = Vec3(10.0 + 10.0 * std::cos(angle), p.y(), sign * 10.0 * std::sin(angle));
        cloth.add(bent, [&](const Vec3& p, const Vec3&) {
            return Vec2(p.z() != 0.0 ? 20.0 : p.x(), p.y());
        });
        const std::vector<PieceFold> folds = cloth.pattern().pieces[0].folds;
        ASSERT_EQ(folds.size(), 1U);                      // the diagonals of the squares are flat
        EXPECT_NEAR(folds[0].angle, -sign * angle, 1e-6); // bent upwards is a valley
        EXPECT_NEAR((folds[0].to - folds[0].from).norm(), 10.0, 1e-6);
        PatternOptions options;
        options.fold_angle = 41.0;
        EXPECT_TRUE(cloth.pattern(options).pieces[0].folds.empty());
    }
}

} // namespace
} // namespace devseg::pattern
