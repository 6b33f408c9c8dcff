// Pieces on a roll of cloth, folded and not; what a cut burns away.
#include "sheet/marker.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/plane/plane.h"
#include "sheet/fabrics.h"
#include "sheet/half_piece.h"
#include "unit/checks.h"
#include "unit/pattern_samples.h"

namespace devseg::sheet {
namespace {

pattern::PatternPiece piece_of(const std::vector<Vec2>& ring, const std::string& name) {
    pattern::PatternPiece piece;
    piece.name = name;
    piece.outer.points = ring;
    piece.outer.area = piece.area = plane::signed_area(ring);
    piece.outer.edges.resize(ring.size());
    piece.outer.half_edge.assign(ring.size(), -1);
    piece.outer.corner.assign(ring.size(), 1);
    piece.box = plane::box_of(ring);
    piece.label_position = piece.box.center();
    piece.label_radius = 10.0;
    piece.grain_direction = Vec2::UnitY();
    return piece;
}

std::vector<Vec2> mirrored(std::vector<Vec2> ring) {
    for (Vec2& p : ring)
        p.x() = -p.x();
    std::reverse(ring.begin(), ring.end());
    return ring;
}

// A hook and its mirror image, an arrow that is its own mirror image, and one more hook.
pattern::Pattern hooks_and_arrow() {
    const std::vector<Vec2> hook = {Vec2(0, 0),   Vec2(60, 0),  Vec2(60, 20),
                                    Vec2(20, 20), Vec2(20, 90), Vec2(0, 90)};
    const std::vector<Vec2> arrow = {Vec2(0, 0), Vec2(80, 0), Vec2(80, 50), Vec2(40, 90),
                                     Vec2(0, 50)};
    pattern::Pattern pattern;
    pattern.pieces = {piece_of(hook, "P1"), piece_of(mirrored(hook), "P2"), piece_of(arrow, "P3"),
                      piece_of(hook, "P4")};
    pattern::find_same_pieces(pattern.pieces, 0.5, Progress());
    pattern.material = material::read_material("cotton");
    return pattern;
}

ExportOptions on_cloth(double width) {
    ExportOptions options;
    options.fabric_width_mm = width;
    options.effort = Effort::fast;
    return options;
}

PatternLayout marker(const pattern::Pattern& pattern, const ExportOptions& given) {
    const ExportOptions options = resolved(given);
    PatternLayout layout;
    for (std::size_t i = 0; i < pattern.pieces.size(); ++i)
        layout.pieces.push_back(compose_piece(pattern, static_cast<Index>(i), {}, options));
    Progress progress;
    lay_out_marker(pattern, options, layout, progress);
    return layout;
}

void expect_inside(const PatternLayout& layout, double left, double right) {
    for (const SheetPiece& piece : layout.pieces) {
        EXPECT_GE(piece.box().min().x(), left - 1e-3) << piece.name;
        EXPECT_LE(piece.box().max().x(), right + 1e-3) << piece.name;
        EXPECT_LE(piece.box().max().y(), layout.fabrics.front().length + 1e-6) << piece.name;
    }
}

TEST(Marker, HasAllPiecesAndCopiesBetweenTheSelvedges) {
    ExportOptions options = on_cloth(200.0);
    options.selvedge_mm = 10.0;
    options.copies = 2;
    const PatternLayout layout = marker(hooks_and_arrow(), options);
    ASSERT_EQ(layout.pieces.size(), 8u);
    EXPECT_EQ(layout.pieces[4].name, "P1-2");
    expect_inside(layout, 10.0, 190.0);
    for (const SheetPiece& piece : layout.pieces) // along the grain
        EXPECT_NEAR(std::abs(piece.frame.placement.cosine), 1.0, 1e-9);
    double area = 0.0;
    for (const SheetPiece& piece : layout.pieces)
        area += plane::signed_area(piece.cut.front());
    EXPECT_NEAR(layout.fabrics.front().use, area / (180.0 * layout.fabrics.front().length), 1e-9);
    EXPECT_GT(layout.fabrics.front().use, 0.6);
}

TEST(Marker, NapTurnsNothingRound) {
    ExportOptions options = on_cloth(200.0);
    options.material = "minky";
    for (const SheetPiece& piece : marker(hooks_and_arrow(), options).pieces)
        EXPECT_NEAR(piece.frame.placement.cosine, 1.0, 1e-9);
}

TEST(Marker, FoldCutsPairsAtOnceAndHalvesAlongIt) {
    ExportOptions options = on_cloth(300.0);
    options.fold = true;
    options.selvedge_mm = 5.0;
    const PatternLayout layout = marker(hooks_and_arrow(), options);
    // A pair of hooks, half an arrow, and a hook that has no partner.
    ASSERT_EQ(layout.pieces.size(), 3u);
    EXPECT_EQ(layout.fabrics.front().single_layer_pieces, 1);
    expect_inside(layout, 0.0, 145.0);
    const SheetPiece* half = nullptr;
    for (const SheetPiece& piece : layout.pieces)
        if (piece.name == "P3-fold")
            half = &piece;
    ASSERT_NE(half, nullptr);
    EXPECT_NEAR(half->box().min().x(), 0.0, 1e-9);
    EXPECT_NEAR(half->box().sizes().x(), 40.0, 0.1);
    EXPECT_NEAR(plane::signed_area(half->cut.front()), 0.5 * (80.0 * 50.0 + 40.0 * 40.0), 5.0);
    // Each arrow of two is the other's mirror image.
    options.copies = 2;
    for (const SheetPiece& piece : marker(hooks_and_arrow(), options).pieces)
        EXPECT_EQ(piece.name.find("fold"), std::string::npos) << piece.name;
}

// Four squares of two materials: one face each.
pattern::Pattern squares_of(const std::vector<Index>& face_material, const std::string& names) {
    pattern::Pattern pattern;
    for (const Index face : {0, 1, 2, 3}) {
        pattern.pieces.push_back(piece_of({Vec2(0, 0), Vec2(50, 0), Vec2(50, 50), Vec2(0, 50)},
                                          "P" + std::to_string(face + 1)));
        pattern.face_piece.push_back(face);
        pattern.source_face.push_back(face);
        pattern.mesh.face_areas.push_back(1.0);
        pattern.mesh.faces.push_back({0, 1, 2});
    }
    pattern::find_same_pieces(pattern.pieces, 0.5, Progress());
    set_fabrics(face_material, names, pattern);
    return pattern;
}

TEST(Marker, EachMaterialHasAStripOfItsOwn) {
    const pattern::Pattern pattern = squares_of({7, 3, 7, 7}, "leather, red fleece");
    EXPECT_EQ(pattern.fabrics, (std::vector<std::string>{"leather", "red fleece"}));
    EXPECT_EQ(pattern.pieces[0].quantity, 3) << "what is cut together is of one material";
    EXPECT_EQ(pattern.pieces[1].quantity, 1);
    EXPECT_EQ(pattern.pieces[3].model, 0);
    const PatternLayout layout = marker(pattern, on_cloth(60.0));
    ASSERT_EQ(layout.sheets.size(), 2u);
    ASSERT_EQ(layout.fabrics.size(), 2u);
    EXPECT_NEAR(layout.fabrics[0].length, 50.0, 0.1);
    EXPECT_NEAR(layout.fabrics[1].length, 156.0, 1.0);
    ASSERT_EQ(layout.pieces.size(), 4u);
    EXPECT_EQ(layout.pieces.front().name, "P2");
    for (const SheetPiece& piece : layout.pieces)
        EXPECT_EQ(piece.sheet, piece.name == "P2" ? 0 : 1);
    const writers::DrawingLayer layer = fabric_layer(layout, {Vec2(0, 0), Vec2(100, 0)});
    ASSERT_EQ(layer.texts.size(), 2u);
    EXPECT_TRUE(checks::contains(layer.texts[1].text, "red fleece"));
    EXPECT_GT(layer.texts[1].position.x(), 100.0);
}

TEST(Marker, MaterialsHaveAsManyNames) {
    EXPECT_TRUE(squares_of({7, 7, 7, 7}, "one, two").fabrics.empty()) << "of one material";
    EXPECT_EQ(squares_of({7, 3, 7, 7}, "").fabrics.back(), "material 7");
    const std::string error = checks::error_of<InvalidParameter>([] {
        squares_of({7, 3, 7, 7}, "one");
    });
    EXPECT_TRUE(checks::contains(error, "material_names")) << error;
}

TEST(Marker, RefusesWhatDoesNotFit) {
    const auto message = [](const ExportOptions& options) {
        return checks::error_of<InvalidParameter>([&] { marker(hooks_and_arrow(), options); });
    };
    EXPECT_TRUE(checks::contains(message(on_cloth(70.0)), "found P3 of 80 mm on 70 mm"))
        << message(on_cloth(70.0));
    ExportOptions options = on_cloth(0.0);
    options.fold = true;
    EXPECT_TRUE(checks::contains(message(options), "fabric_width_mm"));
    options = on_cloth(300.0);
    options.fold = true;
    options.grain = pattern::GrainDirection::free;
    EXPECT_TRUE(checks::contains(message(options), "grain: expected a grain"));
    options = on_cloth(300.0);
    options.page = "a4";
    EXPECT_TRUE(checks::contains(message(options), "either a roll of cloth or a page"));
    options = on_cloth(30.0);
    options.selvedge_mm = 20.0;
    EXPECT_TRUE(checks::contains(message(options), "between its selvedges"));
}

TEST(MirrorAxis, IsFoundWhereThereIsOne) {
    const pattern::Pattern pattern = hooks_and_arrow();
    EXPECT_FALSE(pattern::find_mirror_axis(pattern.pieces[0], 0.5));
    const auto axis = pattern::find_mirror_axis(pattern.pieces[2], 0.5);
    ASSERT_TRUE(axis);
    EXPECT_NEAR(std::abs(axis->direction.y()), 1.0, 1e-6);
    EXPECT_NEAR(axis->point.x(), 40.0, 0.05); // within the tolerance of shapes
}

TEST(Kerf, MovesOutlinesOutwardsAndHolesInwards) {
    pattern::Pattern pattern;
    pattern.pieces = {piece_of({Vec2(0, 0), Vec2(100, 0), Vec2(100, 60), Vec2(0, 60)}, "P1")};
    pattern::PiecePath hole =
        piece_of({Vec2(40, 20), Vec2(40, 40), Vec2(60, 40), Vec2(60, 20)}, "").outer;
    pattern.pieces[0].holes = {hole};
    ExportOptions options;
    options.kerf_mm = 0.4;
    const SheetPiece grown = compose_piece(pattern, 0, {}, resolved(options));
    ASSERT_EQ(grown.cut.size(), 2u);
    const Eigen::AlignedBox2d outer = plane::box_of(grown.cut[0]);
    EXPECT_NEAR(outer.sizes().x(), 100.4, 1e-6);
    EXPECT_NEAR(outer.sizes().y(), 60.4, 1e-6);
    EXPECT_NEAR(plane::box_of(grown.cut[1]).sizes().x(), 19.6, 1e-6);
    EXPECT_GT(plane::signed_area(grown.cut[0]), 0.0);
    EXPECT_LT(plane::signed_area(grown.cut[1]), 0.0);
    options.kerf_mm = -1.0; // the material's, of a laser
    options.material = "leather";
    EXPECT_EQ(resolved(options).kerf_mm, 0.0);
    options.preset = PatternPreset::laser;
    EXPECT_EQ(resolved(options).kerf_mm, material::read_material("leather").kerf_mm);
}

TEST(Marks, DrillsLieWhereDartsEnd) {
    const pattern::Pattern pattern = samples::with_dart(20.0).pattern();
    ExportOptions options;
    EXPECT_TRUE(compose_piece(pattern, 0, {}, options).drills.empty());
    options.drill_marks = true;
    const SheetPiece piece = compose_piece(pattern, 0, {}, options);
    ASSERT_EQ(piece.drills.size(), 2u);
    const auto middle = [](const std::vector<Vec2>& line) {
        return Vec2(0.5 * (line.front() + line.back()));
    };
    EXPECT_LT((middle(piece.drills[0]) - middle(piece.drills[1])).norm(), 1e-9);
    // Its tip is the centre of the grid, 40 mm from the border opposite, but for the scale at which
    // the piece has its area.
    const Vec2 tip = middle(piece.drills[0]);
    EXPECT_NEAR(tip.x() - piece.box().min().x(), 40.0, 1.0);
    const std::vector<Vec2>& ring = piece.cut.front();
    EXPECT_TRUE(std::any_of(ring.begin(), ring.end(),
                            [&](const Vec2& p) { return (p - tip).norm() < 1e-9; }));
}

TEST(Marks, NotchesReachTheCutLineOfEachKindOfSeam) {
    pattern::PatternOptions spaced;
    spaced.notch_spacing_mm = 20.0;
    const pattern::Pattern pattern = samples::two_pieces().pattern(spaced);
    ASSERT_EQ(pattern.seams.size(), 1u);
    ExportOptions options;
    options.seam_allowance_mm = 5.0;
    const auto depth = [&] {
        const SheetPiece piece = compose_piece(pattern, 0, {}, resolved(options));
        EXPECT_FALSE(piece.notches.empty());
        const double edge = piece.box().max().x();
        for (const SheetNotch& notch : piece.notches) {
            EXPECT_NEAR(notch.outer.x(), edge, 1e-6);
            const std::vector<Vec2> triangle = notch.line(NotchKind::triangle);
            EXPECT_EQ(triangle[1], notch.inner);
            EXPECT_LT((0.5 * (triangle[0] + triangle[2]) - notch.outer).norm(), 1e-9);
            EXPECT_GT((triangle[2] - triangle[0]).norm(), 1.0);
            EXPECT_EQ(notch.line(NotchKind::slit).size(), 2u);
        }
        return (piece.notches.front().outer - piece.notches.front().inner).norm();
    };
    const double narrow = depth();
    options.zip_allowance_mm = 15.0;
    options.zip_seams = "1";
    EXPECT_NEAR(depth(), 3.0 * narrow, 1e-6);
}

} // namespace
} // namespace devseg::sheet
