#include "devseg/pack/strip.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/base/numbers.h"

namespace devseg::pack {
namespace {

using Ring = std::vector<Vec2>;

Ring moved(const Ring& ring, const Placement& place) {
    Ring result;
    for (const Vec2& p : ring)
        result.push_back(place(p));
    return result;
}

Ring rectangle(double width, double height) {
    return {Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height)};
}

Ring ell(double size) {
    return {Vec2(0, 0),
            Vec2(size, 0),
            Vec2(size, 0.4 * size),
            Vec2(0.4 * size, 0.4 * size),
            Vec2(0.4 * size, size),
            Vec2(0, size)};
}

double distance(const Ring& a, const Ring& b) {
    double least = infinite;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) {
            const Vec2& p = a[i];
            const Vec2& q = a[(i + 1) % a.size()];
            const Vec2& r = b[j];
            const Vec2& s = b[(j + 1) % b.size()];
            if (plane::segments_touch(p, q, r, s))
                return 0.0;
            for (const Vec2& end : {r, s})
                least = std::min(least, (plane::nearest_point(end, p, q) - end).norm());
            for (const Vec2& end : {p, q})
                least = std::min(least, (plane::nearest_point(end, r, s) - end).norm());
        }
    return plane::is_inside(a, b.front()) || plane::is_inside(b, a.front()) ? 0.0 : least;
}

struct Packed {
    StripResult strip;
    std::vector<Ring> rings;
};

Packed packed(const std::vector<Ring>& rings, std::vector<StripItem> items, double width,
              double gap) {
    for (std::size_t i = 0; i < items.size(); ++i)
        items[i].outline = outline_of({rings[i]});
    Progress progress;
    Packed result{pack_strip(items, {width, gap, 0.3}, progress), {}};
    for (std::size_t i = 0; i < rings.size(); ++i)
        result.rings.push_back(moved(rings[i], result.strip.placements[i]));
    return result;
}

void expect_kept(const Packed& p, double width, double gap) {
    for (std::size_t i = 0; i < p.rings.size(); ++i) {
        for (const Vec2& q : p.rings[i]) {
            EXPECT_GE(q.x(), -1e-3) << i;
            EXPECT_LE(q.x(), width + 1e-3) << i;
            EXPECT_GE(q.y(), -1e-6) << i;
            EXPECT_LE(q.y(), p.strip.length + 1e-6) << i;
        }
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_GE(distance(p.rings[i], p.rings[j]), gap - 1e-3) << i << ' ' << j;
    }
}

std::vector<Ring> some_rings() {
    std::vector<Ring> rings;
    for (int i = 0; i < 12; ++i)
        rings.push_back(i % 2 == 0 ? ell(60.0 + 5.0 * i) : rectangle(30.0 + 4.0 * i, 70.0));
    return rings;
}

TEST(Strip, KeepsItsWidthTheGapAndTheAnglesThatAreAllowed) {
    const std::vector<Ring> rings = some_rings();
    StripItem grained;
    grained.angles = {0.0, pi};
    const Packed p = packed(rings, std::vector<StripItem>(rings.size(), grained), 300.0, 4.0);
    expect_kept(p, 300.0, 4.0);
    for (const Placement& place : p.strip.placements)
        EXPECT_NEAR(std::abs(place.cosine), 1.0, 1e-12);
    double area = 0.0;
    for (const Ring& ring : rings)
        area += plane::signed_area(ring);
    EXPECT_GT(area / (300.0 * p.strip.length), 0.7);
}

TEST(Strip, UsesWhatMayTurn) {
    // Upright they take 3 rows; lying down they fill the width.
    const std::vector<Ring> rings(6, rectangle(50.0, 100.0));
    StripItem grained;
    grained.angles = {0.0};
    const double fixed = packed(rings, std::vector<StripItem>(6, grained), 104.0, 0.5).strip.length;
    EXPECT_NEAR(fixed, 301.0, 2.0);
    const Packed free = packed(rings, std::vector<StripItem>(6), 104.0, 0.5);
    expect_kept(free, 104.0, 0.5);
    EXPECT_LT(free.strip.length, 306.0);
}

TEST(Strip, LeavesAtTheFoldWhatLiesThere) {
    const std::vector<Ring> rings = some_rings();
    std::vector<StripItem> items(rings.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        items[i].angles = {0.0};
        items[i].at_left = i < 4;
    }
    const Packed p = packed(rings, items, 260.0, 3.0);
    expect_kept(p, 260.0, 3.0);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(plane::box_of(p.rings[i]).min().x(), 0.0, 1e-9) << i;
}

TEST(Strip, HoldsWhatIsAsWideAsIt) {
    const std::vector<Ring> rings = {rectangle(200.0, 50.0), rectangle(80.0, 80.0),
                                     rectangle(200.0, 40.0)};
    StripItem upright;
    upright.angles = {0.0};
    const Packed p = packed(rings, std::vector<StripItem>(3, upright), 200.0, 2.0);
    expect_kept(p, 200.0, 2.0);
    EXPECT_NEAR(p.strip.length, 174.0, 1.5);
}

TEST(Strip, IsTheSameAgainAndCanBeCancelled) {
    const std::vector<Ring> rings = some_rings();
    const std::vector<StripItem> items(rings.size());
    const Packed one = packed(rings, items, 300.0, 2.0);
    const Packed two = packed(rings, items, 300.0, 2.0);
    for (std::size_t i = 0; i < rings.size(); ++i)
        EXPECT_EQ(one.strip.placements[i].offset, two.strip.placements[i].offset);
    std::vector<StripItem> filled = items;
    for (std::size_t i = 0; i < rings.size(); ++i)
        filled[i].outline = outline_of({rings[i]});
    for (const int stop : {1, 3}) {
        int calls = 0;
        Progress cancelled([&](double, const char*) { return ++calls < stop; });
        EXPECT_THROW(pack_strip(filled, {300.0, 2.0}, cancelled), Cancelled);
        EXPECT_EQ(calls, stop);
    }
    Progress progress;
    EXPECT_EQ(pack_strip({}, {300.0, 2.0}, progress).length, 0.0);
}

} // namespace
} // namespace devseg::pack
