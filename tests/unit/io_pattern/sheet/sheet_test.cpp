// Folds, numbers and places of pieces on their sheets.
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/plane/plane.h"
#include "sheet/drawing_plan.h"
#include "sheet/export_options.h"
#include "sheet/layout.h"
#include "sheet/page_nesting.h"
#include "sheet/sheet_drawing.h"
#include "unit/checks.h"

namespace devseg::sheet {
namespace {

SheetPiece rectangle(double width, double height) {
    SheetPiece piece;
    piece.cut = {{Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height)}};
    return piece;
}

TEST(Nesting, FillsSheetsWithoutOverlap) {
    const SheetPiece large = rectangle(90, 55);
    const SheetPiece small = rectangle(20, 40);
    const SheetPiece huge = rectangle(300, 20);
    const std::vector<const SheetPiece*> pieces = {&small, &large, &small, &huge, &large, &large};
    Progress progress;
    const Nesting nesting = nest_pieces(pieces, {100.0, 120.0, 2.0, false}, progress);
    EXPECT_EQ(nesting.sheet[3], -1) << "longer than the sheet";
    EXPECT_EQ(nesting.sheet_count, 2);
    std::vector<Eigen::AlignedBox2d> boxes(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (nesting.sheet[i] < 0)
            continue;
        SheetPiece placed = *pieces[i];
        placed.move(nesting.placements[i]);
        boxes[i] = placed.box();
        EXPECT_GE(boxes[i].min().minCoeff(), -1e-6);
        EXPECT_LE(boxes[i].max().x(), 100.0 + 1e-6);
        EXPECT_LE(boxes[i].max().y(), 120.0 + 1e-6);
        for (std::size_t j = 0; j < i; ++j)
            if (nesting.sheet[j] == nesting.sheet[i]) {
                EXPECT_GE(boxes[i].exteriorDistance(boxes[j]), 2.0 - 1e-6) << i << ' ' << j;
            }
    }
}

// An image of the first piece in cells of the sheet's size would take terabytes.
TEST(Nesting, LeavesOutPiecesThatAreFarTooWide) {
    const SheetPiece huge = rectangle(1e6, 1e6);
    const SheetPiece upright = rectangle(80, 900);
    Progress progress;
    const Nesting endless = nest_pieces({&huge, &upright}, {100.0, 0.0, 2.0, false}, progress);
    EXPECT_EQ(endless.sheet, (std::vector<Index>{-1, 0}));
    const Nesting page = nest_pieces({&huge, &upright}, {100.0, 120.0, 2.0, false}, progress);
    EXPECT_EQ(page.sheet, (std::vector<Index>{-1, -1}));
}

PageFormat small_page() {
    return {Vec2(120.0, 160.0), 10.0}; // 100 x 140 mm to print on
}

std::vector<SheetPiece> put_on_pages(std::vector<SheetPiece> pieces, PageNesting& nesting) {
    Progress progress;
    nesting = nest_on_pages(pieces, small_page(), true, progress);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        pieces[i].move(nesting.placements[i]);
        pieces[i].sheet = nesting.sheet[i];
    }
    return pieces;
}

// How many pages have something on them.
std::size_t printed(const std::vector<SheetPiece>& placed, const PageNesting& nesting) {
    PatternLayout layout;
    layout.page = small_page();
    layout.sheets = nesting.sheets;
    layout.pieces = placed;
    writers::Drawing drawing;
    drawing.sheets.resize(layout.sheets.size());
    return printed_pages(layout, drawing).size();
}

// Of two rectangles that may be turned: 0 where a corner of one lies in the other.
double gap_between(const SheetPiece& a, const SheetPiece& b) {
    double gap = 1e9;
    for (const auto& [p, q] : {std::pair(&a, &b), std::pair(&b, &a)})
        for (const Vec2& corner : p->cut.front()) {
            const std::vector<Vec2>& ring = q->cut.front();
            if (plane::is_inside(q->cut, corner))
                return 0.0;
            for (std::size_t k = 0; k < ring.size(); ++k)
                gap = std::min(gap, plane::distance(corner, ring[k], ring[(k + 1) % ring.size()]));
        }
    return gap;
}

TEST(PageNesting, PiecesThatFitOnAPageLieInsideItsBorder) {
    PageNesting nesting;
    std::vector<SheetPiece> pieces(9, rectangle(45, 60));
    pieces.push_back(rectangle(150, 120)); // takes two pages, and leaves room on the second
    const std::vector<SheetPiece> placed = put_on_pages(pieces, nesting);
    for (std::size_t i = 0; i + 1 < placed.size(); ++i) {
        const PatternSheet& sheet = nesting.sheets[at(placed[i].sheet)];
        int homes = 0;
        for (Index row = 0; row < sheet.rows; ++row)
            for (Index column = 0; column < sheet.columns; ++column) {
                const PageFormat page = small_page();
                const Vec2 low =
                    Vec2::Constant(page.margin + 0.4) + Vec2(column, row).cwiseProduct(page.step());
                const Eigen::AlignedBox2d inside(low, low + page.printable() - Vec2::Constant(0.8));
                homes += inside.contains(placed[i].box()) ? 1 : 0;
            }
        EXPECT_GE(homes, 1) << i << " lies on the border of its page";
        for (std::size_t j = 0; j < placed.size(); ++j)
            if (i != j && placed[i].sheet == placed[j].sheet) {
                EXPECT_GE(gap_between(placed[i], placed[j]), piece_gap - 1e-6);
            }
    }
}

TEST(PageNesting, LargePiecesShareTheirPages) {
    PageNesting nesting;
    // Each is a page and a half long: three of them take five pages one by one, and six apart.
    put_on_pages({rectangle(90, 200), rectangle(90, 200), rectangle(90, 200)}, nesting);
    Index pages = 0;
    for (const PatternSheet& sheet : nesting.sheets)
        pages += sheet.columns * sheet.rows;
    EXPECT_LE(pages, 5);
}

// Images on the grid are larger than their pieces, and few turns are tried at first.
TEST(PageNesting, WhatFitsOnAPageNarrowlyLiesOnOne) {
    for (const SheetPiece& piece : {rectangle(138.5, 98.5), rectangle(160, 6)}) {
        PageNesting nesting;
        put_on_pages({piece}, nesting);
        ASSERT_EQ(nesting.sheets.size(), 1U);
        EXPECT_EQ(nesting.sheets.front().columns * nesting.sheets.front().rows, 1)
            << piece.box().sizes().transpose();
    }
}

TEST(PageNesting, CrossesStandInTheMiddleOfStrips) {
    const PatternSheet sheet{Vec2(210, 290), 2, 2}; // of small pages
    const std::vector<Vec2> crosses = strip_crosses(sheet, small_page());
    EXPECT_EQ(crosses.size(), 8U);
    for (const Vec2& place : crosses)
        EXPECT_TRUE(std::abs(place.x() - 105.0) < 1e-9 || std::abs(place.y() - 145.0) < 1e-9);
}

TEST(PageNesting, KnowsWhereAPieceNeedsTheFewestPages) {
    // A cross of 200 by 200: in the corner, its upright bar lies on two columns of pages.
    SheetPiece cross;
    const double b = 85, c = 115, e = 200;
    cross.cut = {{Vec2(b, 0), Vec2(c, 0), Vec2(c, b), Vec2(e, b), Vec2(e, c), Vec2(c, c),
                  Vec2(c, e), Vec2(b, e), Vec2(b, c), Vec2(0, c), Vec2(0, b), Vec2(b, b)}};
    PageNesting nesting;
    const std::vector<SheetPiece> placed = put_on_pages({cross}, nesting);
    EXPECT_EQ(printed(placed, nesting), 4U);
}

TEST(PageNesting, ManyPiecesFillPagesInOrder) {
    std::vector<SheetPiece> pieces{rectangle(200, 40)}; // too long for a page
    for (int i = 0; i < 300; ++i)
        pieces.push_back(rectangle(30, 20));
    PageNesting nesting;
    const std::vector<SheetPiece> placed = put_on_pages(pieces, nesting);
    for (std::size_t i = 0; i < placed.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (placed[i].sheet == placed[j].sheet) {
                ASSERT_GE(gap_between(placed[i], placed[j]), piece_gap - 1e-6) << i << ' ' << j;
            }
    // With their gaps, 18 small ones fit on a page.
    EXPECT_LE(printed(placed, nesting), 22U);
}

TEST(PageNesting, IsTheSameInEveryRunAndCanBeCancelled) {
    std::vector<SheetPiece> pieces;
    for (int i = 0; i < 12; ++i)
        pieces.push_back(rectangle(30 + 7 * (i % 5), 40 + 11 * (i % 7)));
    PageNesting one;
    PageNesting other;
    const std::vector<SheetPiece> a = put_on_pages(pieces, one);
    const std::vector<SheetPiece> b = put_on_pages(pieces, other);
    for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_EQ(a[i].cut, b[i].cut);
    Progress cancelled([](double, const char*) { return false; });
    EXPECT_THROW(nest_on_pages(pieces, small_page(), true, cancelled), Cancelled);
}

TEST(Drawing, HolesAreCutBeforeOutlinesAndWhatLiesInThemFirst) {
    SheetPiece frame = rectangle(100, 100);
    frame.name = "P01";
    frame.cut.push_back({Vec2(20, 20), Vec2(20, 80), Vec2(80, 80), Vec2(80, 20)});
    SheetPiece small = rectangle(30, 30);
    small.name = "P02";
    small.move({1.0, 0.0, Vec2(40, 40)});
    SheetPiece beside = rectangle(30, 30);
    beside.name = "P03";
    beside.move({1.0, 0.0, Vec2(110, 0)});
    PatternLayout layout;
    layout.pieces = {frame, beside, small};
    layout.sheets = {{Vec2(150, 100)}};
    const writers::Drawing drawing = draw_sheets(layout, ExportOptions());
    const std::vector<writers::DrawingPath>& cut = drawing.layers.front().paths;
    ASSERT_EQ(cut.size(), 3U);
    EXPECT_EQ(cut[0].id, "P02-cut");
    EXPECT_EQ(cut[1].id, "P01-cut");
    EXPECT_EQ(cut[2].id, "P03-cut");
    ASSERT_EQ(cut[1].parts.size(), 2U);
    EXPECT_LT(plane::signed_area(cut[1].parts[0].points), 0.0);
    EXPECT_GT(plane::signed_area(cut[1].parts[1].points), 0.0);
}

TEST(PageSize, KnowsNamesAndSizes) {
    ExportOptions options;
    EXPECT_FALSE(page_format(options));
    for (const auto& [name, size] :
         {std::pair("A4", Vec2(210, 297)), std::pair("letter", Vec2(215.9, 279.4)),
          std::pair("600x400.5", Vec2(600, 400.5))}) {
        options.page = name;
        EXPECT_EQ(page_format(options)->size, size);
    }
    for (const char* wrong : {"a5", "600", "x", "-10x20", "600x400mm", "nanx100", "1e9x1e9"}) {
        options.page = wrong;
        EXPECT_EQ(checks::error_of<InvalidParameter>([&] {
                      page_format(options);
                  }).rfind("page: expected ", 0),
                  0u)
            << wrong;
    }
}

} // namespace
} // namespace devseg::sheet
