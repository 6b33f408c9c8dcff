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
#include <utility>

#include "devseg/pack/first_fit.h"

// Integer loops are compiled for several instruction sets, chosen when the program starts: the same
// bytes on all of them. Where the compiler or the C library cannot choose, or a sanitizer runs
// before the choice is made, the plain build is used.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__) &&       \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define DEVSEG_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define DEVSEG_SIMD_CLONES
#endif

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

constexpr std::size_t looks_at_row = 8; // how often a row of places may turn out hopeless
constexpr int call_overhead = 24;       // of a run, in operations

DEVSEG_SIMD_CLONES
void add_difference(std::int32_t* sum, const std::int32_t* plus, const std::int32_t* minus,
                    Index count) {
    for (Index x = 0; x < count; ++x)
        sum[x] += plus[x] - minus[x];
}

DEVSEG_SIMD_CLONES
std::int32_t least_of(const std::int32_t* values, Index count) {
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    for (Index x = 0; x < count; ++x)
        least = std::min(least, values[x]);
    return least;
}

} // namespace

std::vector<std::size_t> by_size(const std::vector<ChartPoses>& poses) {
    std::vector<std::size_t> order(poses.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const ChartCells& p = poses[a].front();
        const ChartCells& q = poses[b].front();
        return p.width * p.height > q.width * q.height;
    });
    return order;
}

Separation::Separation(const std::vector<ChartPoses>& poses, std::uint64_t seed,
                       const Progress& progress, std::vector<std::uint8_t> at_left)
    : poses_(poses), progress_(progress), at_left_(std::move(at_left)), random_state_(seed),
      placed_(poses.size(), 1), boxes_(poses.size()), totals_(poses.size(), 0),
      overlaps_(poses.size() * poses.size(), 0), weights_(poses.size() * poses.size(), 1.0) {
    at_left_.resize(poses.size(), 0);
    windows_.resize(poses.size());
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

void Separation::confine(std::vector<std::vector<Window>> windows) {
    windows_ = std::move(windows);
    windows_.resize(poses_.size());
}

// Where the corner of an image may lie, in each of the chart's windows that is large enough.
std::vector<Window> Separation::places_within(std::size_t i, const ChartCells& c) const {
    std::vector<Window> places;
    const auto add = [&](const Window& cells) {
        const Window here{cells.left, cells.right + 1 - c.width, cells.bottom,
                          cells.top + 1 - c.height};
        if (!here.empty())
            places.push_back(here);
    };
    if (windows_[i].empty())
        add({0, right_of(i, c) + c.width - 1, 0, frame_.height - 1});
    for (const Window& window : windows_[i])
        add(window);
    return places;
}

// The place in the windows that is nearest to one.
Spot Separation::nearest_place(std::size_t i, std::size_t pose, const Spot& spot) const {
    Spot best{pose, spot.x, spot.y};
    Index least = std::numeric_limits<Index>::max();
    for (const Window& w : places_within(i, poses_[i][pose])) {
        const Spot here{pose, std::clamp(spot.x, w.left, w.right),
                        std::clamp(spot.y, w.bottom, w.top)};
        const Index distance = std::abs(here.x - spot.x) + std::abs(here.y - spot.y);
        if (distance < least) {
            least = distance;
            best = here;
        }
    }
    return best;
}

Layout Separation::insert_all(const std::vector<std::size_t>& order, const Frame& frame,
                              const SeparationOptions& options) {
    layout_.assign(poses_.size(), Spot{});
    frame_ = frame;
    if (!clamp_to_frame())
        return {};
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
        const Index right = at_left_[i] != 0 ? images.front().cells.width : frame.width;
        if (!cells.put(images, {0, right, 0, frame.height}, layout_[i]))
            return {};
    }
    return layout_;
}

bool Separation::run(Layout& layout, const Frame& frame, const SeparationOptions& options,
                     std::int64_t& work) {
    layout_ = layout;
    frame_ = frame;
    work_ = work;
    if (!clamp_to_frame())
        return false;
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
            if (totals_[i] > 0 && !is_fixed(i)) {
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

// False when a chart has no pose that fits.
bool Separation::clamp_to_frame() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
        if (!fits(i, cells(i))) {
            const auto other = std::find_if(poses_[i].begin(), poses_[i].end(),
                                            [&](const ChartCells& c) { return fits(i, c); });
            if (other == poses_[i].end())
                return false;
            layout_[i].pose = static_cast<std::size_t>(other - poses_[i].begin());
        }
        layout_[i] = nearest_place(i, layout_[i].pose, layout_[i]);
    }
    return true;
}

bool Separation::is_fixed(std::size_t i) const {
    if (windows_[i].size() != 1 || poses_[i].size() != 1)
        return false;
    const Window& w = windows_[i].front();
    return w.right - w.left + 1 == cells(i).width && w.top - w.bottom + 1 == cells(i).height;
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

std::vector<Window> Separation::windows_of(std::size_t i, std::size_t pose, Index reach) const {
    const ChartCells& c = poses_[i][pose];
    std::vector<Window> windows = places_within(i, c);
    if (reach == 0)
        return windows;
    // Poses of different sizes keep their centre.
    const Index x = layout_[i].x + (cells(i).width - c.width) / 2;
    const Index y = layout_[i].y + (cells(i).height - c.height) / 2;
    for (Window& w : windows)
        w = {std::max(w.left, x - reach), std::min(w.right, x + reach),
             std::max(w.bottom, y - reach), std::min(w.top, y + reach)};
    return windows;
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
    for (const std::size_t pose : chosen)
        for (const Window& places : windows_of(i, pose, reach)) {
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
        for (const Window& places : windows_of(i, pose, reach))
            places_.look(poses_[i][pose], pose, places);
    layout_[i] = places_.best();
    work_ -= places_.work() - before;
}

void PlaceSearch::clear(const Window& area) {
    area_ = area;
    // One more than the cells: sums have two ends.
    half_ = at((area.right - area.left + 2) / 2 + 1);
    steps_.assign(2 * half_ * at(area.top - area.bottom + 1), 0);
}

void PlaceSearch::add_obstacle(const ChartCells& cells, const Spot& spot, std::int32_t weight) {
    if (spot.x > area_.right || spot.x + cells.width <= area_.left || spot.y > area_.top ||
        spot.y + cells.height <= area_.bottom)
        return;
    for (const WeightedRun& run : cells.obstacle) {
        const Index y = run.cells.row + spot.y;
        const Index first = std::max(run.cells.first + spot.x, area_.left);
        const Index last = std::min(run.cells.last + spot.x, area_.right + 1);
        if (y < area_.bottom || y > area_.top || first >= last)
            continue;
        std::int32_t* steps = steps_.data() + 2 * half_ * at(y - area_.bottom);
        steps[first - area_.left] += run.weight * weight;
        steps[last - area_.left] -= run.weight * weight;
    }
    work_ += 8 * static_cast<std::int64_t>(cells.obstacle.size());
}

void PlaceSearch::sum_rows() {
    sums_.resize(steps_.size());
    for (std::size_t begin = 0; begin < steps_.size(); begin += 2 * half_) {
        const std::int32_t* step = steps_.data() + begin;
        std::int32_t* even = sums_.data() + begin;
        std::int32_t* odd = even + half_;
        std::int32_t weight = 0;
        std::int32_t sum = 0;
        for (std::size_t k = 0; k < half_; ++k) {
            even[k] = sum;
            weight += step[2 * k];
            sum += weight;
            odd[k] = sum;
            weight += step[2 * k + 1];
            sum += weight;
        }
    }
    work_ += static_cast<std::int64_t>(2 * steps_.size());
}

void PlaceSearch::begin(const ChartCells& cells, const Spot& spot) {
    // A place may lie next to one that is better by this much.
    constexpr double look_factor = 1.5;
    sum_rows();
    best_ = spot;
    best_cost_ = cost_at(cells, spot.x, spot.y);
    look_limit_ = static_cast<std::int32_t>(
        std::min<double>(std::numeric_limits<std::int32_t>::max(), look_factor * best_cost_ + 1.0));
}

void PlaceSearch::begin(const Spot& spot) {
    sum_rows();
    best_ = spot;
    best_cost_ = std::numeric_limits<std::int32_t>::max();
    look_limit_ = std::numeric_limits<std::int32_t>::max();
}

std::int32_t PlaceSearch::cost_at(const ChartCells& cells, Index x, Index y) {
    std::int32_t cost = 0;
    for (const CellRun& run : cells.runs) {
        const std::int32_t* sums = row(y + run.row);
        cost += sums[index(x + run.last)] - sums[index(x + run.first)];
    }
    work_ += 8 * static_cast<std::int64_t>(cells.runs.size());
    return cost;
}

// Costs of every second place of a row; false as soon as none can be less than the limit.
bool PlaceSearch::sum_costs(const ChartCells& cells, const Window& places, Index y,
                            std::int32_t limit) {
    const Index count = (places.right - places.left) / 2 + 1;
    costs_.assign(at(count), 0);
    // Rows far from one another come first: they find the hopeless places early.
    const std::size_t stride = std::max<std::size_t>(1, cells.runs.size() / looks_at_row);
    for (std::size_t start = 0; start < std::min(stride, cells.runs.size()); ++start) {
        for (std::size_t k = start; k < cells.runs.size(); k += stride) {
            const CellRun& run = cells.runs[k];
            const std::int32_t* sums = row(y + run.row);
            add_difference(costs_.data(), sums + index(places.left + run.last),
                           sums + index(places.left + run.first), count);
            work_ += count + call_overhead;
        }
        if (least_of(costs_.data(), count) >= limit)
            return false;
    }
    return true;
}

void PlaceSearch::look(const ChartCells& cells, std::size_t pose, const Window& places) {
    if (places.empty() || best_cost_ == 0)
        return;
    Spot found{pose, 0, 0};
    std::int32_t limit = look_limit_;
    for (Index y = places.bottom; y <= places.top && limit > 0; y += 2) {
        if (!sum_costs(cells, places, y, limit))
            continue;
        const auto least = std::min_element(costs_.begin(), costs_.end());
        found.x = places.left + 2 * static_cast<Index>(least - costs_.begin());
        found.y = y;
        limit = *least;
    }
    if (limit == look_limit_)
        return;
    look_limit_ = limit;
    descend(cells, found, limit, places);
}

void PlaceSearch::descend(const ChartCells& cells, Spot spot, std::int32_t cost,
                          const Window& places) {
    for (bool moved = true; moved && cost > 0;) {
        moved = false;
        const Spot center = spot;
        for (Index y = center.y - 1; y <= center.y + 1; ++y)
            for (Index x = center.x - 1; x <= center.x + 1; ++x) {
                if ((x == center.x && y == center.y) || x < places.left || x > places.right ||
                    y < places.bottom || y > places.top)
                    continue;
                const std::int32_t near_cost = cost_at(cells, x, y);
                if (near_cost < cost) {
                    cost = near_cost;
                    spot = {spot.pose, x, y};
                    moved = true;
                }
            }
    }
    if (cost < best_cost_) {
        best_cost_ = cost;
        best_ = spot;
    }
}

} // namespace devseg::pack
