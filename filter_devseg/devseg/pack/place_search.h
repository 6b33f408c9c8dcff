// The cheapest place for a chart among weighted obstacles, over all places of a window.
//
// The weights of the obstacles are summed along the rows of the grid once. Then a run of the
// chart's cells costs one difference of two sums, for all places of a row at the same time.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pack/outline_raster.h"
#include "devseg/pack/pack.h"

namespace devseg::pack {

/// Where a chart lies: the corner cell of the image of one of its poses.
struct Spot {
    std::size_t pose = 0;
    Index x = 0;
    Index y = 0;
};

/// Of a chart whose image lies there, on cells of this size.
inline Placement placement_of(const ChartCells& cells, const Spot& spot, double cell) {
    return {cells.cosine, cells.sine, cells.offset + cell * Vec2(spot.x, spot.y)};
}

/// A range of cells or of places; right and top are the last ones.
struct Window {
    Index left = 0;
    Index right = -1;
    Index bottom = 0;
    Index top = -1;
    bool empty() const { return left > right || bottom > top; }
    bool touches(const Window& other) const {
        return left <= other.right && other.left <= right && bottom <= other.top &&
               other.bottom <= top;
    }
};

class PlaceSearch {
public:
    /// Forgets all obstacles; `area` holds all cells that the chart may cover.
    void clear(const Window& area);
    void add_obstacle(const ChartCells& cells, const Spot& spot, std::int32_t weight);

    /// To be called when all obstacles are there; `cost` is that of `spot`, where the chart lies.
    void begin(const ChartCells& cells, const Spot& spot);
    /// The same for a chart that lies nowhere yet: any place is better.
    void begin(const Spot& spot);

    /// Looks at all places of a pose; every second one in x and in y, and from the best of them
    /// downhill to its neighbours.
    void look(const ChartCells& cells, std::size_t pose, const Window& places);

    const Spot& best() const { return best_; }
    /// Elementary operations so far.
    std::int64_t work() const { return work_; }

private:
    void sum_rows();
    std::int32_t cost_at(const ChartCells& cells, Index x, Index y);
    bool sum_costs(const ChartCells& cells, const Window& places, Index y, std::int32_t limit);
    void descend(const ChartCells& cells, Spot spot, std::int32_t cost, const Window& places);
    const std::int32_t* row(Index y) const {
        return sums_.data() + 2 * half_ * at(y - area_.bottom);
    }
    // Sums at even columns come before those at odd ones, to read every second one at once.
    std::size_t index(Index x) const {
        return at((x - area_.left) / 2) + ((x - area_.left) % 2 != 0 ? half_ : 0);
    }

    Window area_;
    std::size_t half_ = 0;            // half of a row's length
    std::vector<std::int32_t> steps_; // changes of the weight along the rows
    std::vector<std::int32_t> sums_;  // of the weights of the cells to the left
    std::vector<std::int32_t> costs_; // of every second place in a row
    Spot best_;
    std::int32_t best_cost_ = 0;
    std::int32_t look_limit_ = 0; // a coarse look goes on to the neighbours below this cost
    std::int64_t work_ = 0;
};

} // namespace devseg::pack
