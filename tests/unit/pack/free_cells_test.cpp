// Charts on a grid, each at its lowest and then leftmost free place, beside a search of all places.
#include "devseg/pack/first_fit.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "unit/mesh_edits.h"

namespace devseg::pack {
namespace {

using shapes::Random;

// A run in each row, as long as up to the whole width.
FitImage ragged(Random& random, Index width) {
    ChartCells image;
    image.height = 1 + random.below(4);
    const Index most = random.below(4) == 0 ? width : 1 + width / 5;
    for (Index row = 0; row < image.height; ++row) {
        const Index first = random.below(3);
        const Index last = std::min(width, first + 1 + random.below(most));
        image.runs.push_back({row, std::min(first, last - 1), last});
        image.width = std::max(image.width, last);
        image.count += last - image.runs.back().first;
    }
    return FitImage(image);
}

class PlainGrid {
public:
    explicit PlainGrid(Index width) : width_(width) {}

    Spot put(const ChartCells& image) {
        for (Index y = 0;; ++y)
            for (Index x = 0; x + image.width <= width_; ++x)
                if (take(image, x, y))
                    return {0, x, y};
    }

private:
    bool take(const ChartCells& image, Index x, Index y) {
        rows_.resize(std::max(rows_.size(), at(y + image.height)), std::vector<bool>(at(width_)));
        for (const CellRun& run : image.runs)
            for (Index k = run.first; k < run.last; ++k)
                if (rows_[at(y + run.row)][at(x + k)])
                    return false;
        for (const CellRun& run : image.runs)
            for (Index k = run.first; k < run.last; ++k)
                rows_[at(y + run.row)][at(x + k)] = true;
        return true;
    }

    Index width_;
    std::vector<std::vector<bool>> rows_;
};

TEST(FreeCells, ChartsLieAtTheirLowestPlaceThenTheLeftmost) {
    Random random(5);
    for (const Index width : {1, 63, 64, 65, 200}) {
        std::vector<FitImage> images;
        Index longest = 1;
        for (int i = 0; i < 120; ++i) {
            images.push_back(ragged(random, width));
            for (const CellRun& run : images.back().runs)
                longest = std::max(longest, run.last - run.first);
        }
        FreeCells cells(width, longest);
        PlainGrid plain(width);
        for (const FitImage& image : images) {
            Spot spot;
            ASSERT_TRUE(cells.put({image}, FitWindow{}, spot));
            const Spot expected = plain.put(image.cells);
            ASSERT_EQ(spot.y, expected.y) << width;
            ASSERT_EQ(spot.x, expected.x) << width;
        }
    }
}

} // namespace
} // namespace devseg::pack
