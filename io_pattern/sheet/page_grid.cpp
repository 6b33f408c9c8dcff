#include "sheet/page_grid.h"

#include <algorithm>
#include <cmath>

namespace devseg::sheet {

namespace {

// From the origin of images, which have a margin, to the border of the printable area.
constexpr double inset = 0.5 * piece_gap - border_clearance;
// Images reach this far into a page that their piece touches, even at its corner.
const double reach = 0.5 * piece_gap * std::sqrt(0.5) - border_clearance;

} // namespace

PageGrid::PageGrid(const PageProblem& problem, Index columns, Index rows, Index singles,
                   Index factor)
    : problem_(&problem), columns_(columns), rows_(rows), singles_(singles), factor_(factor) {}

std::array<Index, 2> PageGrid::own_range(Index page, Index pages, int axis) const {
    const double step = problem_->page.step()[axis];
    const double low = page == 0 ? 0.0 : page * step + tile_overlap + inset + reach;
    const double high = (page + 1) * step + tile_overlap + inset - (page + 1 < pages ? reach : 0.0);
    const double cell = factor_ * problem_->cell;
    if (factor_ > 1)
        return {static_cast<Index>(std::lround(low / cell)),
                static_cast<Index>(std::lround(high / cell)) - 1};
    return {static_cast<Index>(std::floor(low / cell)),
            static_cast<Index>(std::ceil(high / cell)) - 1};
}

// In cells of the problem.
std::array<Index, 2> PageGrid::clear_range(Index page, Index pages, int axis) const {
    const double cell = problem_->cell;
    const double low = page * problem_->page.step()[axis] / cell;
    const double strip = tile_overlap / cell;
    const Index room = axis == 0 ? problem_->columns : problem_->rows;
    return {static_cast<Index>(std::ceil(low + (page > 0 ? strip : 0.0))),
            static_cast<Index>(std::floor(low + room - (page + 1 < pages ? strip : 0.0))) - 1};
}

pack::Window PageGrid::coarse(const pack::Window& fine) const {
    const auto rounded = [&](Index cells) { return (cells + factor_ / 2) / factor_; };
    pack::Window window{rounded(fine.left), 0, rounded(fine.bottom), 0};
    window.right = window.left + rounded(fine.right + 1 - fine.left) - 1;
    window.top = window.bottom + rounded(fine.top + 1 - fine.bottom) - 1;
    return window;
}

pack::Window PageGrid::own(Index page) const {
    const auto x = own_range(page % columns_, columns_, 0);
    const auto y = own_range(page / columns_, rows_, 1);
    return {x[0], x[1], y[0], y[1]};
}

pack::Window PageGrid::clear(Index page) const {
    if (page < glued()) {
        const auto x = clear_range(page % columns_, columns_, 0);
        const auto y = clear_range(page / columns_, rows_, 1);
        return coarse({x[0], x[1], y[0], y[1]});
    }
    const Index single = page - glued();
    // Beyond the ring that is closed around the sheet.
    const Index bottom = (rows_ > 0 ? clear_range(rows_ - 1, rows_, 1)[1] + 1 : 0) +
                         (single / columns_ + 1) * problem_->rows + factor_;
    const Index left = single % columns_ * problem_->columns;
    return coarse({left, left + problem_->columns - 1, bottom, bottom + problem_->rows - 1});
}

pack::Window PageGrid::sheet() const {
    if (rows_ == 0)
        return {};
    return coarse(
        {0, clear_range(columns_ - 1, columns_, 0)[1], 0, clear_range(rows_ - 1, rows_, 1)[1]});
}

pack::ChartCells PageGrid::closed(const std::vector<std::uint8_t>& is_open,
                                  pack::Spot& spot) const {
    // Around the sheet as wide as a page: the way out of it leads back onto the sheet.
    const Index ring = problem_->rows / factor_;
    const pack::Window all = sheet();
    pack::ChartCells image;
    image.width = all.right + 1 + 2 * ring;
    image.height = all.top + 1 + 2 * ring;
    spot = {0, -ring, -ring};
    std::vector<std::uint8_t> is_free(at(image.width), 0);
    for (Index y = 0; y < image.height; ++y) {
        std::fill(is_free.begin(), is_free.end(), std::uint8_t{0});
        if (y >= ring && y - ring <= all.top) {
            std::fill_n(is_free.begin() + ring, all.right + 1, std::uint8_t{1});
            for (Index page = 0; page < glued(); ++page) {
                const pack::Window w = own(page);
                if (is_open[at(page)] != 0 || y - ring < w.bottom || y - ring > w.top)
                    continue;
                std::fill(is_free.begin() + ring + w.left,
                          is_free.begin() + ring + std::min(w.right, all.right) + 1,
                          std::uint8_t{0});
            }
        }
        for (Index x = 0; x < image.width;) {
            const Index first = x;
            while (x < image.width && is_free[at(x)] == 0)
                ++x;
            if (x > first)
                image.runs.push_back({y, first, x});
            image.count += x - first;
            while (x < image.width && is_free[at(x)] != 0)
                ++x;
        }
    }
    if (factor_ > 1)
        return pack::coarsen(image, 1); // with the depth of its cells
    for (const pack::CellRun& run : image.runs)
        image.obstacle.push_back({run, 1});
    return image;
}

void PageGrid::count(const pack::ChartCells& image, const pack::Spot& spot,
                     std::vector<Index>& cells) const {
    std::vector<std::array<Index, 2>> across;
    for (Index column = 0; column < columns_; ++column)
        across.push_back(own_range(column, columns_, 0));
    for (Index row = 0; row < rows_; ++row) {
        const std::array<Index, 2> up = own_range(row, rows_, 1);
        // Runs come row by row. Parts of pages may share a row of cells.
        const auto begin =
            std::lower_bound(image.runs.begin(), image.runs.end(), up[0] - spot.y,
                             [](const pack::CellRun& run, Index y) { return run.row < y; });
        for (auto run = begin; run != image.runs.end() && run->row + spot.y <= up[1]; ++run)
            for (Index column = 0; column < columns_; ++column)
                cells[at(row * columns_ + column)] +=
                    std::max(Index{0}, std::min(across[at(column)][1] + 1, spot.x + run->last) -
                                           std::max(across[at(column)][0], spot.x + run->first));
    }
}

} // namespace devseg::sheet
