#include "devseg/pack/place_search.h"

#include <algorithm>
#include <limits>

#include "devseg/pack/simd_clones.h"

namespace devseg::pack {

namespace {

constexpr std::int32_t huge = std::numeric_limits<std::int32_t>::max();
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
    std::int32_t least = huge;
    for (Index x = 0; x < count; ++x)
        least = std::min(least, values[x]);
    return least;
}

} // namespace

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
    look_limit_ = static_cast<std::int32_t>(std::min<double>(huge, look_factor * best_cost_ + 1.0));
}

void PlaceSearch::begin(const Spot& spot) {
    sum_rows();
    best_ = spot;
    best_cost_ = huge;
    look_limit_ = huge;
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
