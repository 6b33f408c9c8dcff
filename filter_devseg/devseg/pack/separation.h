// Guided local search for a layout without overlaps.
//
// Charts lie on a grid and may overlap. A chart that overlaps others moves to the pose and place
// where it costs least, each pair of charts weighing as much as it has been in the way so far; the
// weights of pairs that still overlap grow from round to round, which drives the search out of
// local minima.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pack/place_search.h"

namespace devseg::pack {

using Layout = std::vector<Spot>; // one for each chart
using ChartPoses = std::vector<ChartCells>;

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
    Separation(const std::vector<ChartPoses>& poses, std::uint64_t seed, const Progress& progress);

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

    /// True when every chart has a pose that fits into the frame.
    bool fits(const Frame& frame) const;

private:
    void clamp_to_frame();
    std::int64_t measure_all();
    void measure(std::size_t i);
    Window box_of(std::size_t i) const;
    void raise_weights();
    void move(std::size_t i, const SeparationOptions& options);
    std::vector<std::size_t> choose_poses(std::size_t i, std::size_t count);
    Window window_of(std::size_t i, std::size_t pose, Index reach) const;
    std::uint64_t random(std::uint64_t bound);

    bool fits(const ChartCells& c) const {
        return c.width <= frame_.width && c.height <= frame_.height;
    }
    const ChartCells& cells(std::size_t i) const { return poses_[i][layout_[i].pose]; }

    const std::vector<ChartPoses>& poses_;
    const Progress& progress_;
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
