#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "devseg/pack/first_fit.h"
#include "sheet/page_places.h"

namespace devseg::sheet {
namespace {

bool has_bit(const Bits& bits, Index x) {
    return (bits[at(x / bits_in_word)] >> (x % bits_in_word) & 1) != 0;
}

// Two runs in each row.
pack::ChartCells comb(Index width, Index height) {
    pack::ChartCells cells;
    cells.width = width;
    cells.height = height;
    for (Index y = 0; y < height; ++y) {
        cells.runs.push_back({y, y % 3, width / 3});
        cells.runs.push_back({y, width / 2 + y % 2, width});
    }
    return cells;
}

bool covers(const pack::ChartCells& cells, Index x, Index y) {
    for (const pack::CellRun& run : cells.runs)
        if (run.row == y && run.first <= x && x < run.last)
            return true;
    return false;
}

TEST(PagePlaces, BitsAreCountedAndFound) {
    Bits bits(words_for(200), 0);
    set_bits(bits, 60, 131);
    set_bits(bits, 199, 200);
    set_bits(bits, 5, 5);
    EXPECT_EQ(count_bits(bits), 72);
    EXPECT_EQ(nth_bit(bits, 0), 60);
    EXPECT_EQ(nth_bit(bits, 70), 130);
    EXPECT_EQ(nth_bit(bits, 71), 199);
    EXPECT_TRUE(any_bit(bits));
    EXPECT_FALSE(any_bit(Bits(3, 0)));
}

TEST(PagePlaces, CandidatesThatWereCountedLeastStay) {
    std::minstd_rand random(7);
    const Index width = 150;
    PlaceCounts counts(words_for(width));
    for (int round = 0; round < 2; ++round) {
        counts.clear();
        std::vector<Index> times(at(width), 0);
        for (int k = 0; k < 40; ++k) {
            Bits places(words_for(width), 0);
            const Index first = static_cast<Index>(random() % 100);
            set_bits(places, first, first + 50);
            counts.add(places);
            for (Index x = first; x < first + 50; ++x)
                ++times[at(x)];
        }
        Bits candidates(words_for(width), 0);
        set_bits(candidates, 40, 110);
        const Index least = *std::min_element(times.begin() + 40, times.begin() + 110);
        EXPECT_EQ(counts.keep_least(candidates), least);
        for (Index x = 0; x < width; ++x)
            EXPECT_EQ(has_bit(candidates, x), x >= 40 && x < 110 && times[at(x)] == least) << x;
    }
}

TEST(PagePlaces, AnImageReachesIntoARectangleWhereACellOfItLiesThere) {
    const pack::ChartCells image = comb(70, 9);
    const Index width = 5;
    const Index height = 4;
    const Reach reach(image, width, height);
    const Index places = 200;
    for (const auto& [left, bottom] : {std::pair<Index, Index>(90, 12), {0, 3}, {196, 0}})
        for (Index y = 0; y < 20; ++y) {
            Bits found(words_for(places), 0);
            reach.add_places(left, bottom, y, found);
            for (Index x = 0; x < places; ++x) {
                bool touches = false;
                for (Index v = bottom; v < bottom + height; ++v)
                    for (Index u = left; u < left + width; ++u)
                        touches = touches || covers(image, u - x, v - y);
                ASSERT_EQ(has_bit(found, x), touches) << left << ' ' << x << ' ' << y;
            }
        }
}

TEST(PagePlaces, PlacesOnOthersAreBlocked) {
    const pack::FitImage image(comb(40, 6));
    pack::FreeCells cells(240, 240);
    EXPECT_NE(cells.blocked(image, 0), nullptr);
    cells.take(image, {0, 30, 2});
    cells.take(image, {0, 100, 5});
    Index full = 0;
    for (Index y = 0; y < 12; ++y) {
        const Bits* blocked = cells.blocked(image, y);
        for (Index x = 0; x < 240; ++x)
            ASSERT_EQ(blocked == nullptr || has_bit(*blocked, x), !cells.is_free(image, {0, x, y}))
                << x << ' ' << y;
        full += blocked == nullptr ? 1 : 0;
    }
    EXPECT_EQ(full, 0) << "there is room at the right";
    EXPECT_EQ(cells.blocked(pack::FitImage(comb(241, 2)), 0), nullptr) << "wider than the board";
}

} // namespace
} // namespace devseg::sheet
