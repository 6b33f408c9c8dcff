// Guided local search for nesting:
//   J. Egeblad, B. K. Nielsen, A. Odgaard: "Fast neighborhood search for two- and three-dimensional
//   nesting problems", European Journal of Operational Research 183(3), 2007,
//   doi:10.1016/j.ejor.2005.11.063
//   S. Umetani, M. Yagiura, S. Imahori, T. Imamichi, K. Nonobe, T. Ibaraki: "Solving the irregular
//   strip packing problem via guided local search for overlap minimization", International
//   Transactions in Operational Research 16(6), 2009, doi:10.1111/j.1475-3995.2009.00707.x
// Growth and decay of the weights:
//   J. Gardeyn, G. Vanden Berghe, T. Wauters: "An open-source heuristic to reboot 2D nesting
//   research", 2025, arXiv:2509.13329
// Here places are cells and their costs exact sums, instead of samples and polygons.
#include "devseg/pack/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "devseg/pack/free_cells.h"

namespace devseg::pack {

namespace {

constexpr double weight_unit = 16.0;  // the field counts in sixteenths of the least weight
constexpr double slow_growth = 1.2;   // of the weight of the pair that overlaps least
constexpr double fast_growth = 2.0;   // of the pair that overlaps most
constexpr double weight_decay = 0.95; // of pairs that do not overlap, back to 1
constexpr std::int64_t pair_work = 8; // operations to look at a pair of charts
constexpr double deepest = 16.0;      // mean weight of an obstacle's cells, at most

// Cells that two placed images share.
Index shared_cells(const ChartCells& a, const Spot& at_a, const ChartCells& b, const Spot& at_b) {
    const Index dx = at_b.x - at_a.x;
    const Index dy = at_b.y - at_a.y;
    const auto before = [](const CellRun& run, Index row) { return run.row < row; };
    auto p = std::lower_bound(a.runs.begin(), a.runs.end(), dy, before);
    auto q = std::lower_bound(b.runs.begin(), b.runs.end(), -dy, before);
    Index count = 0;
    while (p != a.runs.end() && q != b.runs.end()) {
        const Index row = q->row + dy;
        if (p->row == row)
            count += std::max(Index{0},
                              std::min(p->last, q->last + dx) - std::max(p->first, q->first + dx));
        if (p->row < row || (p->row == row && p->last <= q->last + dx))
            ++p;
        else
            ++q;
    }
    return count;
}

} // namespace

Separation::Separation(const std::vector<ChartPoses>& poses, std::uint64_t seed,
                       const Progress& progress)
    : poses_(poses), progress_(progress), random_state_(seed), placed_(poses.size(), 1),
      boxes_(poses.size()), totals_(poses.size(), 0), overlaps_(poses.size() * poses.size(), 0),
      weights_(poses.size() * poses.size(), 1.0) {
    Index largest = 1;
    for (const ChartPoses& chart : poses)
        for (const ChartCells& pose : chart)
            largest = std::max(largest, pose.count);
    // Costs must not overflow, even where a chart lies on two others that weigh most.
    weight_limit_ = std::max(1.0, std::numeric_limits<std::int32_t>::max() /
                                      (2.0 * deepest * weight_unit * largest));
}

// SplitMix64: small, and the same numbers everywhere.
std::uint64_t Separation::random(std::uint64_t bound) {
    random_state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = random_state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return (z ^ (z >> 31)) % bound;
}

bool Separation::fits(const Frame& frame) const {
    return std::all_of(poses_.begin(), poses_.end(), [&](const ChartPoses& chart) {
        return std::any_of(chart.begin(), chart.end(), [&](const ChartCells& c) {
            return c.width <= frame.width && c.height <= frame.height;
        });
    });
}

Layout Separation::insert_all(const std::vector<std::size_t>& order, const Frame& frame,
                              const SeparationOptions& options) {
    layout_.assign(poses_.size(), Spot{});
    frame_ = frame;
    if (!fits(frame))
        return {};
    clamp_to_frame();
    std::fill(weights_.begin(), weights_.end(), 1.0);
    std::fill(placed_.begin(), placed_.end(), char{0});
    for (const std::size_t i : order) {
        progress_.check();
        move(i, options);
        boxes_[i] = box_of(i);
        placed_[i] = 1;
    }
    return layout_;
}

Layout Separation::fit_all(const std::vector<std::size_t>& order, const Frame& frame) {
    layout_.assign(poses_.size(), Spot{});
    FreeCells cells(frame.width, frame.width);
    for (const std::size_t i : order) {
        progress_.check();
        const std::vector<FitImage> images(poses_[i].begin(), poses_[i].end());
        if (!cells.put(images, 0, frame.height + 1, layout_[i]))
            return {};
    }
    return layout_;
}

bool Separation::run(Layout& layout, const Frame& frame, const SeparationOptions& options,
                     std::int64_t& work) {
    if (!fits(frame))
        return false;
    layout_ = layout;
    frame_ = frame;
    work_ = work;
    clamp_to_frame();
    std::fill(weights_.begin(), weights_.end(), 1.0);
    const std::size_t n = poses_.size();
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::int64_t total = measure_all();
    std::int64_t least = total;
    for (int idle = 0; total > 0 && idle < options.patience && work_ > 0; ++idle) {
        for (std::size_t i = n; i > 1; --i)
            std::swap(order[i - 1], order[random(i)]);
        for (const std::size_t i : order)
            if (totals_[i] > 0) {
                progress_.check();
                move(i, options);
                measure(i);
            }
        total = std::accumulate(totals_.begin(), totals_.end(), std::int64_t{0});
        raise_weights();
        if (total < least) {
            least = total;
            idle = 0;
        }
    }
    work = work_;
    if (total > 0)
        return false;
    layout = layout_;
    return true;
}

void Separation::clamp_to_frame() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
        if (!fits(cells(i))) {
            const auto other = std::find_if(poses_[i].begin(), poses_[i].end(),
                                            [&](const ChartCells& c) { return fits(c); });
            layout_[i].pose = static_cast<std::size_t>(other - poses_[i].begin());
        }
        layout_[i].x = std::clamp(layout_[i].x, Index{0}, frame_.width - cells(i).width);
        layout_[i].y = std::clamp(layout_[i].y, Index{0}, frame_.height - cells(i).height);
    }
}

std::int64_t Separation::measure_all() {
    for (std::size_t i = 0; i < poses_.size(); ++i)
        boxes_[i] = box_of(i);
    for (std::size_t i = 0; i < poses_.size(); ++i)
        measure(i);
    return std::accumulate(totals_.begin(), totals_.end(), std::int64_t{0});
}

// Brings the overlaps of a chart that has moved up to date.
void Separation::measure(std::size_t i) {
    const std::size_t n = poses_.size();
    boxes_[i] = box_of(i);
    for (std::size_t j = 0; j < n; ++j) {
        if (j == i)
            continue;
        Index& old = overlaps_[i * n + j];
        const Index shared = boxes_[i].touches(boxes_[j])
                                 ? shared_cells(cells(i), layout_[i], cells(j), layout_[j])
                                 : 0;
        if (shared == old)
            continue;
        totals_[i] += shared - old;
        totals_[j] += shared - old;
        old = shared;
        overlaps_[j * n + i] = shared;
    }
    work_ -= pair_work * static_cast<std::int64_t>(n);
}

Window Separation::box_of(std::size_t i) const {
    return {layout_[i].x, layout_[i].x + cells(i).width - 1, layout_[i].y,
            layout_[i].y + cells(i).height - 1};
}

void Separation::raise_weights() {
    const double most = *std::max_element(overlaps_.begin(), overlaps_.end());
    for (std::size_t k = 0; k < weights_.size(); ++k) {
        const double factor = overlaps_[k] > 0
                                  ? slow_growth + (fast_growth - slow_growth) * overlaps_[k] / most
                                  : weight_decay;
        weights_[k] = std::clamp(weights_[k] * factor, 1.0, weight_limit_);
    }
}

Window Separation::window_of(std::size_t i, std::size_t pose, Index reach) const {
    const ChartCells& c = poses_[i][pose];
    const Index far_x = frame_.width - c.width;
    const Index far_y = frame_.height - c.height;
    if (reach == 0)
        return {0, far_x, 0, far_y};
    // Poses of different sizes keep their centre.
    const Index x = layout_[i].x + (cells(i).width - c.width) / 2;
    const Index y = layout_[i].y + (cells(i).height - c.height) / 2;
    return {std::max(Index{0}, x - reach), std::min(far_x, x + reach),
            std::max(Index{0}, y - reach), std::min(far_y, y + reach)};
}

// The present pose comes first: it alone is sure to fit.
std::vector<std::size_t> Separation::choose_poses(std::size_t i, std::size_t count) {
    std::vector<std::size_t> chosen = {layout_[i].pose};
    const bool all = poses_[i].size() <= count + 1;
    for (std::size_t k = 0; k < (all ? poses_[i].size() : count); ++k) {
        const std::size_t pose = all ? k : random(poses_[i].size());
        if (pose != layout_[i].pose)
            chosen.push_back(pose);
    }
    return chosen;
}

void Separation::move(std::size_t i, const SeparationOptions& options) {
    const std::vector<std::size_t> chosen = choose_poses(i, options.poses);
    const Index reach = placed_[i] != 0 ? options.reach : 0;
    Window area = box_of(i);
    for (const std::size_t pose : chosen) {
        const Window places = window_of(i, pose, reach);
        if (places.empty())
            continue;
        area.left = std::min(area.left, places.left);
        area.right = std::max(area.right, places.right + poses_[i][pose].width - 1);
        area.bottom = std::min(area.bottom, places.bottom);
        area.top = std::max(area.top, places.top + poses_[i][pose].height - 1);
    }
    const std::int64_t before = places_.work();
    places_.clear(area);
    for (std::size_t j = 0; j < poses_.size(); ++j)
        if (j != i && placed_[j] != 0 && boxes_[j].touches(area))
            places_.add_obstacle(
                cells(j), layout_[j],
                static_cast<std::int32_t>(weight_unit * weights_[i * poses_.size() + j]));
    if (placed_[i] != 0)
        places_.begin(cells(i), layout_[i]);
    else
        places_.begin(layout_[i]);
    for (const std::size_t pose : chosen)
        places_.look(poses_[i][pose], pose, window_of(i, pose, reach));
    layout_[i] = places_.best();
    work_ -= places_.work() - before;
}

} // namespace devseg::pack
