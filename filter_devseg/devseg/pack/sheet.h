// The sheet that charts are placed on: a grid of cells, searched for free places 64 at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devseg/pack/outline_raster.h"

namespace devseg {

/// The cells of a chart, row by row, as runs of set cells.
struct ChartCells {
    struct Run {
        Index row;
        Index first;
        Index length;
    };
    Index width = 0;
    Index height = 0;
    std::vector<Run> runs;       // in an order that finds collisions early
    explicit ChartCells(const BitImage& image);
};

/// A place for a chart: the cell of its image's corner.
struct Spot {
    Index x = 0;
    Index y = 0;
};

class Sheet {
public:
    Sheet(Index width, Index height);

    /// The lowest free place, leftmost in its row, with y + chart height ≤ top_limit.
    std::optional<Spot> find_lowest(const ChartCells& chart, Index top_limit) const;
    void occupy(const ChartCells& chart, const Spot& spot);

private:
    // Row y at level j: bit x says whether any of the cells x … x + 2^j − 1 is taken.
    std::uint64_t* row(Index level, Index y) {
        return cells_.data() + ((static_cast<std::ptrdiff_t>(y) * levels_) + level) * words_;
    }
    const std::uint64_t* row(Index level, Index y) const {
        return cells_.data() + ((static_cast<std::ptrdiff_t>(y) * levels_) + level) * words_;
    }
    void refresh(Index y);

    Index width_;
    Index height_;
    Index words_;
    Index levels_ = 1;
    Index used_rows_ = 0; // rows from here on are empty
    std::vector<std::uint64_t> cells_;
};

} // namespace devseg
