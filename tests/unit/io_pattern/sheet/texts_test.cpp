// Names and numbers in the pieces.
#include "sheet/marks.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "sheet/layout.h"
#include "unit/pattern_samples.h"

namespace devseg::sheet {
namespace {

ExportOptions numbered() {
    ExportOptions options;
    options.edge_numbers = true;
    return options;
}

PatternLayout laid_out(double scale, const ExportOptions& options) {
    pattern::PatternOptions pattern_options;
    pattern_options.mm_per_unit = scale;
    Progress progress;
    return lay_out_pattern(samples::two_pieces().pattern(pattern_options), options, progress);
}

std::size_t number_count(const PatternLayout& layout) {
    std::size_t count = 0;
    for (const SheetPiece& piece : layout.pieces)
        count += piece.numbers.size();
    return count;
}

TEST(Texts, EverySeamHasItsNumberOnBothSides) {
    const PatternLayout layout = laid_out(1.0, numbered());
    EXPECT_EQ(number_count(layout), 2U);
    for (const SheetPiece& piece : layout.pieces) {
        EXPECT_GE(piece.names.size(), 1U);
        for (const writers::DrawingText& text : piece.numbers)
            EXPECT_GE(text.size, 2.5);
    }
    EXPECT_TRUE(layout.left_out.seams.empty());
    EXPECT_TRUE(layout.left_out.pieces.empty());
}

// Pieces of 2 × 4 mm.
TEST(Texts, WithoutRoomThereAreNoneAndTheLayoutSaysSo) {
    const PatternLayout layout = laid_out(0.05, numbered());
    EXPECT_EQ(number_count(layout), 0U);
    EXPECT_EQ(layout.left_out.seams, (std::vector<Index>{0}));
    EXPECT_EQ(layout.left_out.pieces, (std::vector<Index>{0, 1}));
    EXPECT_EQ(layout_notes(samples::two_pieces().pattern(), layout).size(), 2U);
}

TEST(Layout, PiecesTooNarrowToBeGluedAreNamed) {
    ExportOptions options;
    options.glue_tabs = true;
    for (const auto& [scale, narrow] : {std::pair(0.05, 2U), std::pair(1.0, 0U)}) {
        const PatternLayout layout = laid_out(scale, options);
        EXPECT_EQ(layout.narrow.size(), narrow);
        const std::vector<std::string> notes =
            layout_notes(samples::two_pieces().pattern(), layout);
        EXPECT_EQ(std::count_if(notes.begin(), notes.end(),
                                [](const std::string& note) {
                                    return note.find("less than 3 mm") != std::string::npos;
                                }),
                  narrow > 0 ? 1 : 0);
    }
    EXPECT_TRUE(laid_out(0.05, numbered()).narrow.empty()); // nothing is glued
}

SheetPiece strip(double width, double height) {
    SheetPiece piece;
    piece.piece = 0;
    piece.name = "P01";
    piece.cut = {{Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height)}};
    return piece;
}

pattern::Pattern pattern_of(double width, double height) {
    pattern::Pattern pattern;
    pattern.pieces.resize(1);
    pattern::PatternPiece& piece = pattern.pieces[0];
    piece.name = "P01";
    piece.outer.points = strip(width, height).cut[0];
    piece.label_position = Vec2(0.5 * width, 0.5 * height);
    piece.label_radius = 0.5 * std::min(width, height);
    return pattern;
}

TEST(Texts, NamesCrossNoFoldsWhereThereIsRoom) {
    const pattern::Pattern pattern = pattern_of(60.0, 40.0);
    std::vector<SheetPiece> pieces{strip(60.0, 40.0)};
    pieces[0].mountains = {{Vec2(0, 20), Vec2(60, 20)}, {Vec2(30, 0), Vec2(30, 40)}};
    EXPECT_TRUE(add_texts(pattern, {}, {}, pieces).pieces.empty());
    ASSERT_EQ(pieces[0].names.size(), 1U);
    const Vec2 place = pieces[0].names[0].position;
    EXPECT_GT(std::abs(place.y() - 20.0), 0.36 * pieces[0].names[0].size);
    EXPECT_GT(std::abs(place.x() - 30.0), 0.8 * pieces[0].names[0].size);
}

TEST(Texts, NamesMayCrossFoldsThatLeaveNoRoom) {
    const pattern::Pattern pattern = pattern_of(30.0, 20.0);
    std::vector<SheetPiece> pieces{strip(30.0, 20.0)};
    for (int i = 1; i < 20; ++i)
        pieces[0].valleys.push_back({Vec2(0, i), Vec2(30, i)});
    EXPECT_TRUE(add_texts(pattern, {}, {}, pieces).pieces.empty());
    EXPECT_EQ(pieces[0].names.size(), 1U);
}

// A dart of 20 mm, and as wide as given at its mouth.
std::size_t numbers_of_dart(double width) {
    pattern::Pattern pattern = pattern_of(60.0, 40.0);
    pattern::PatternPiece& piece = pattern.pieces[0];
    piece.outer.points = {
        {0, 0}, {30 - 0.5 * width, 0}, {30, 20}, {30 + 0.5 * width, 0}, {60, 0}, {60, 40}, {0, 40}};
    pattern::Seam seam;
    seam.number = 1;
    seam.label = "1";
    seam.is_dart = true;
    const double length = std::hypot(0.5 * width, 20.0);
    seam.sides[0] = {0, 0, 1, 1, false, length, {}};
    seam.sides[1] = {0, 0, 2, 1, true, length, {}};
    pattern.seams = {seam};
    piece.outer.edges.resize(piece.outer.points.size());
    piece.outer.edges[1] = piece.outer.edges[2] = {0, 0, true};
    std::vector<SheetPiece> pieces{strip(60.0, 40.0)};
    pieces[0].cut = {piece.outer.points};
    EXPECT_TRUE(add_texts(pattern, {}, numbered(), pieces).seams.empty());
    return pieces[0].numbers.size();
}

TEST(Texts, DartsHaveOneNumber) {
    EXPECT_EQ(numbers_of_dart(4.0), 1U);
    EXPECT_EQ(numbers_of_dart(40.0), 1U);
}

TEST(Texts, NumbersThatAreOthersUpsideDownAreTold) {
    for (const char* number : {"6", "9", "16", "91", "66", "81", "198"})
        EXPECT_TRUE(is_ambiguous(number)) << number;
    for (const char* number : {"1", "8", "11", "69", "60", "26", "7", "6 (3)", "88", "101"})
        EXPECT_FALSE(is_ambiguous(number)) << number;
}

// One side of the seam lies in a slot too narrow for a number beside it.
TEST(Texts, LinesLeadToNumbersThatLieApart) {
    pattern::Pattern pattern = pattern_of(40.0, 30.0);
    pattern::PatternPiece& piece = pattern.pieces[0];
    piece.outer.points = {{0, 0},     {20, 0},    {20, 10}, {40, 10},
                          {40, 11.5}, {20, 11.5}, {20, 30}, {0, 30}};
    pattern::Seam seam;
    seam.number = 1;
    seam.label = "1";
    seam.sides[0] = {0, 0, 3, 1, false, 1.5, {}};
    seam.sides[1] = {0, 0, 7, 1, true, 30.0, {}};
    pattern.seams = {seam};
    piece.outer.edges.resize(piece.outer.points.size());
    piece.outer.edges[3] = piece.outer.edges[7] = {0, 0, false};
    std::vector<SheetPiece> pieces{strip(1, 1)};
    pieces[0].cut = {piece.outer.points};
    ExportOptions options = numbered();
    options.labels = false;
    const LeftOut left_out = add_texts(pattern, {}, options, pieces);
    ASSERT_TRUE(left_out.seams.empty());
    ASSERT_EQ(pieces[0].numbers.size(), 2U);
    ASSERT_EQ(pieces[0].leaders.size(), 1U);
    EXPECT_LT((pieces[0].leaders[0][0] - Vec2(40.0, 10.75)).norm(), 1.0);
}

} // namespace
} // namespace devseg::sheet
