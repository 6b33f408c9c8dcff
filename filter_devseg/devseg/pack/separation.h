// Guided local search for a layout without overlaps.
//
// Charts lie on a grid and may overlap. A chart that overlaps others moves to the pose and place
// where it costs least, each pair of charts weighing as much as it has been in the way so far; the
// weights of pairs that still overlap grow from round to round, which drives the search out of
// local minima.
//
// The weights of the obstacles are summed along the rows of the grid once. Then a run of the
// chart's cells costs one difference of two sums, for all places of a row at the same time.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pack/outline.h"
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

using Layout = std::vector<Spot>; // one for each chart
using ChartPoses = std::vector<ChartCells>;

/// The numbers of the charts from the largest box, in the first pose, to the smallest.
std::vector<std::size_t> by_size(const std::vector<ChartPoses>& poses);

/// The rectangle to fill, in cells.
struct Frame {
    Index width = 0;
    Index height = 0;
};

struct SeparationOptions {
    Index reach = 0;       // cells that a move covers at most in x and in y; 0: anywhere
    std::size_t poses = 8; // that a move looks at besides the present one
    int patience = 100;    // rounds without progress before giving up
};

class Separation {
public:
    /// `poses` outlives the object. The seed chooses among the possible orders of moves.
    /// `at_left` (#poses, or empty): 1 for charts that stay at the left side of the frame.
    Separation(const std::vector<ChartPoses>& poses, std::uint64_t seed, const Progress& progress,
               std::vector<std::uint8_t> at_left = {});

    /// Charts with windows (#poses; each a list) lie within one of theirs, whatever the frame, and
    /// the others anywhere in it. A chart whose only window is as large as the chart never moves.
    void confine(std::vector<std::vector<Window>> windows);

    /// Lays the charts out one after the other, each at the lowest free place or, where there is
    /// none, at the cheapest; nothing when a chart is larger than the frame.
    Layout insert_all(const std::vector<std::size_t>& order, const Frame& frame,
                      const SeparationOptions& options);

    /// Lays the charts out one after the other, each at the lowest free place; nothing when the
    /// frame is too small.
    Layout fit_all(const std::vector<std::size_t>& order, const Frame& frame);

    /// Moves charts until none overlap in the frame; false, and the layout as it was, when that
    /// fails. Effort is counted, never timed: the search gives up when `work`, in cell operations,
    /// is used up, and subtracts what it took.
    bool run(Layout& layout, const Frame& frame, const SeparationOptions& options,
             std::int64_t& work);

    /// True when every chart has a pose that fits into the frame, without windows.
    bool fits(const Frame& frame) const;

private:
    bool clamp_to_frame();
    bool is_fixed(std::size_t i) const;
    Spot nearest_place(std::size_t i, std::size_t pose, const Spot& spot) const;
    std::int64_t measure_all();
    void measure(std::size_t i);
    Window box_of(std::size_t i) const;
    void raise_weights();
    void move(std::size_t i, const SeparationOptions& options);
    std::vector<std::size_t> choose_poses(std::size_t i, std::size_t count);
    std::vector<Window> windows_of(std::size_t i, std::size_t pose, Index reach) const;
    std::uint64_t random(std::uint64_t bound);

    Index right_of(std::size_t i, const ChartCells& c) const {
        return at_left_[i] != 0 ? 0 : frame_.width - c.width;
    }
    bool fits(std::size_t i, const ChartCells& c) const { return !places_within(i, c).empty(); }
    std::vector<Window> places_within(std::size_t i, const ChartCells& c) const;
    const ChartCells& cells(std::size_t i) const { return poses_[i][layout_[i].pose]; }

    const std::vector<ChartPoses>& poses_;
    const Progress& progress_;
    std::vector<std::uint8_t> at_left_;
    std::vector<std::vector<Window>> windows_; // #poses; none: the frame
    std::uint64_t random_state_;
    double weight_limit_ = 1.0;
    Frame frame_;
    std::int64_t work_ = 0;
    Layout layout_;
    std::vector<char> placed_;         // whether the chart counts for the others
    std::vector<Window> boxes_;        // of the charts' cells
    std::vector<std::int64_t> totals_; // the overlap of each chart with all others, cells
    std::vector<Index> overlaps_;      // #n by #n, cells
    std::vector<double> weights_;      // #n by #n
    PlaceSearch places_;
};

} // namespace devseg::pack
