#include "sheet/tabs.h"

#include <polyclipping/clipper.hpp>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"

namespace devseg::sheet {
namespace {

// Two squares that are joined along the whole of their outlines: one seam for each side.
pattern::Pattern two_squares(double side, double notch) {
    pattern::Pattern pattern;
    for (int k = 0; k < 2; ++k) {
        pattern::PatternPiece piece;
        const Vec2 low(2.0 * side * k, 0.0);
        piece.outer.points = {low, low + Vec2(side, 0), low + Vec2(side, side),
                              low + Vec2(0.5 * side, side - notch), low + Vec2(0, side)};
        for (const Vec2& p : piece.outer.points)
            piece.box.extend(p);
        pattern.pieces.push_back(piece);
    }
    for (Index i = 0; i < 5; ++i) {
        pattern::Seam seam;
        seam.number = i + 1;
        seam.sides[0] = {0, 0, i, 1, false, 0.0, {}};
        seam.sides[1] = {1, 0, i, 1, true, 0.0, {}};
        pattern.seams.push_back(seam);
    }
    return pattern;
}

ClipperLib::Path path_of(const std::vector<Vec2>& points) {
    ClipperLib::Path path;
    for (const Vec2& p : points)
        path.emplace_back(std::llround(1e6 * p.x()), std::llround(1e6 * p.y()));
    return path;
}

std::vector<Vec2> polygon(const pattern::Pattern& pattern, const GlueTab& tab) {
    const std::vector<Vec2>& points = pattern.pieces[tab.piece].path(tab.path).points;
    std::vector<Vec2> ring;
    for (Index i = tab.count; i >= 0; --i)
        ring.push_back(points[at(tab.first + i) % points.size()]);
    ring.push_back(tab.corner[0]);
    ring.push_back(tab.corner[1]);
    return ring;
}

double common_area(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    ClipperLib::Clipper clipper;
    clipper.AddPath(path_of(a), ClipperLib::ptSubject, true);
    clipper.AddPath(path_of(b), ClipperLib::ptClip, true);
    ClipperLib::Paths common;
    clipper.Execute(ClipperLib::ctIntersection, common, ClipperLib::pftNonZero,
                    ClipperLib::pftNonZero);
    double area = 0.0;
    for (const ClipperLib::Path& path : common)
        area += std::abs(ClipperLib::Area(path)) * 1e-12;
    return area;
}

void expect_no_overlap(const pattern::Pattern& pattern, const GlueTabs& tabs) {
    for (std::size_t p = 0; p < pattern.pieces.size(); ++p)
        for (std::size_t i = 0; i < tabs.tabs[p].size(); ++i) {
            const std::vector<Vec2> tab = polygon(pattern, tabs.tabs[p][i]);
            EXPECT_LT(common_area(tab, pattern.pieces[p].outer.points), 1e-5);
            for (std::size_t j = 0; j < i; ++j)
                EXPECT_LT(common_area(tab, polygon(pattern, tabs.tabs[p][j])), 1e-5);
        }
}

TEST(GlueTabs, OneForEachSeam) {
    Progress progress;
    const pattern::Pattern pattern = two_squares(50.0, 0.0);
    const GlueTabs tabs = make_tabs(pattern, {5.0}, progress);
    EXPECT_EQ(tabs.tabs[0].size() + tabs.tabs[1].size(), 5u);
    EXPECT_EQ(tabs.seams_without, 0);
    for (const GlueTab& tab : tabs.tabs[0])
        EXPECT_NEAR((tab.corner[0] - tab.corner[1]).norm(),
                    tab.first < 2 || tab.first == 4 ? 40.0 : 15.0, 1e-9);
    expect_no_overlap(pattern, tabs);
}

// The notch is too narrow for two tabs of full depth side by side.
TEST(GlueTabs, GiveWayAtConcaveCorners) {
    Progress progress;
    for (const double notch : {5.0, 15.0, 30.0, 45.0}) {
        const pattern::Pattern pattern = two_squares(50.0, notch);
        const GlueTabs tabs = make_tabs(pattern, {8.0}, progress);
        EXPECT_GE(tabs.tabs[0].size() + tabs.tabs[1].size(), 4u);
        expect_no_overlap(pattern, tabs);
    }
}

TEST(GlueTabs, BothSidesOrTurnsOrNarrowTriangles) {
    Progress progress;
    const pattern::Pattern pattern = two_squares(50.0, 0.0);
    const GlueTabs both = make_tabs(pattern, {5.0, TabSides::both}, progress);
    EXPECT_EQ(both.tabs[0].size(), 5u);
    EXPECT_EQ(both.tabs[1].size(), 5u);
    expect_no_overlap(pattern, both);
    // Sides of 8 mm are too short for a tab of 5 mm that is no triangle.
    const pattern::Pattern small = two_squares(8.0, 0.0);
    const GlueTabs narrow = make_tabs(small, {5.0}, progress);
    std::size_t triangles = 0;
    for (const std::vector<GlueTab>& tabs : narrow.tabs)
        for (const GlueTab& tab : tabs)
            triangles += tab.corner[0] == tab.corner[1] ? 1 : 0;
    EXPECT_EQ(triangles, 5u);
    expect_no_overlap(small, narrow);
}

TEST(GlueTabs, AlternateAlongASeam) {
    // The seam turns by 90 degrees twice: three stretches.
    pattern::Pattern pattern = two_squares(50.0, 0.0);
    pattern.seams.resize(1);
    pattern.seams[0].sides[0] = {0, 0, 0, 3, false, 0.0, {}};
    pattern.seams[0].sides[1] = {1, 0, 0, 3, true, 0.0, {}};
    Progress progress;
    const GlueTabs tabs = make_tabs(pattern, {5.0, TabSides::alternating}, progress);
    EXPECT_EQ(tabs.tabs[0].size(), 2u);
    EXPECT_EQ(tabs.tabs[1].size(), 1u);
}

TEST(GlueTabs, OpenBordersGetSomeIfAsked) {
    pattern::Pattern pattern = two_squares(50.0, 0.0);
    pattern.seams.clear();
    for (pattern::PatternPiece& piece : pattern.pieces)
        piece.outer.edges.assign(5, {});
    Progress progress;
    EXPECT_TRUE(make_tabs(pattern, {5.0}, progress).tabs[0].empty());
    const GlueTabs tabs = make_tabs(pattern, {5.0, TabSides::one, true}, progress);
    // The two halves of the upper side are one stretch.
    ASSERT_EQ(tabs.tabs[0].size() + tabs.tabs[1].size(), 8u);
    EXPECT_TRUE(tabs.tabs[0][0].on_border);
    EXPECT_TRUE(tabs.shadows.empty());
    expect_no_overlap(pattern, tabs);
}

TEST(GlueTabs, CastShadowsOnTheOtherPiece) {
    pattern::Pattern pattern = two_squares(50.0, 0.0);
    pattern.seams.resize(1);
    Progress progress;
    const GlueTabs tabs = make_tabs(pattern, {5.0}, progress);
    ASSERT_EQ(tabs.shadows.size(), 1u);
    const TabShadow& shadow = tabs.shadows[0];
    EXPECT_EQ(shadow.piece, 1);
    // On the lower side of the other square, 5 mm into it, as long as the tab.
    const std::vector<Vec2> expected{{150, 0}, {145, 5}, {105, 5}, {100, 0}};
    ASSERT_EQ(shadow.line.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_LT((shadow.line[i] - expected[i]).norm(), 1e-9);
}

TEST(GlueTabs, NoRoomIsReported) {
    Progress progress;
    const pattern::Pattern pattern = two_squares(1.0, 0.0); // sides far shorter than the depth
    EXPECT_EQ(make_tabs(pattern, {5.0}, progress).seams_without, 5);
}

TEST(GlueTabs, CanBeCancelled) {
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW({ make_tabs(two_squares(50.0, 0.0), {5.0}, progress); }, Cancelled);
}

} // namespace
} // namespace devseg::sheet
