// Which pages of a sheet are printed.
#include "sheet/page_cover.h"

#include <gtest/gtest.h>

#include "sheet/drawing_plan.h"
#include "sheet/layout.h"
#include "sheet/sheet_drawing.h"

namespace devseg::sheet {
namespace {

// Two columns and two rows of pages have three parts to a side.
TEST(PageCover, StripsAreOnPagesThatArePrintedAnyway) {
    EXPECT_EQ(cover_parts(2, 2, {0, 1, 1, 0, 0, 0, 0, 0, 0}),
              (std::vector<Index>{-1, 1, 1, -1, -1, -1, -1, -1, -1}));
    EXPECT_EQ(cover_parts(2, 2, {1, 1, 0, 0, 1, 0, 0, 0, 1}),
              (std::vector<Index>{0, 0, -1, -1, 0, -1, -1, -1, 3}));
}

TEST(PageCover, OnePageShowsWhatTwoStripsShare) {
    EXPECT_EQ(cover_parts(2, 2, {0, 0, 0, 0, 1, 0, 0, 0, 0}),
              (std::vector<Index>{-1, -1, -1, -1, 0, -1, -1, -1, -1}));
    EXPECT_EQ(cover_parts(2, 2, {0, 0, 0, 0, 0, 1, 0, 1, 0}),
              (std::vector<Index>{-1, -1, -1, -1, -1, 3, -1, 3, -1}))
        << "the page that shows the most comes first";
    EXPECT_EQ(cover_parts(1, 1, {5}), std::vector<Index>{0});
    EXPECT_TRUE(cover_parts(0, 0, {}).empty());
}

std::size_t printed_count(double left, double width) {
    PatternLayout layout;
    layout.page = PageFormat{Vec2(120.0, 160.0), 10.0}; // 100 x 140 mm to print on
    layout.sheets = {{Vec2(210.0, 160.0), 2, 1}};
    SheetPiece piece;
    piece.cut = {{Vec2(0, 0), Vec2(width, 0), Vec2(width, 100), Vec2(0, 100)}};
    piece.move({1.0, 0.0, Vec2(10.0 + left, 20.0)});
    layout.pieces = {piece};
    writers::Drawing drawing;
    drawing.sheets.resize(1);
    return printed_pages(layout, drawing).size();
}

TEST(PageCover, APageShowsItsStripsOnBothSides) {
    EXPECT_EQ(printed_count(0.0, 100.0), 1U);
    EXPECT_EQ(printed_count(90.0, 100.0), 1U);
    EXPECT_EQ(printed_count(92.0, 5.0), 1U) << "a strip alone is on one page";
    EXPECT_EQ(printed_count(89.0, 100.0), 2U);
    EXPECT_EQ(printed_count(40.0, 100.0), 2U);
}

} // namespace
} // namespace devseg::sheet
