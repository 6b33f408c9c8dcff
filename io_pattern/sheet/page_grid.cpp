#include "sheet/page_grid.h"

#include <algorithm>
#include <cmath>

namespace devseg::sheet {

namespace {

// From the origin of images, which have a margin, to the border of the printable area.
constexpr double inset = 0.5 * piece_gap - border_clearance;
// Images reach this far into a page that their piece touches, even at its corner.
const double reach = 0.5 * piece_gap * std::sqrt(0.5) - border_clearance;

bool is_within(const pack::Window& window, const pack::ChartCells& image, const pack::Spot& spot) {
    return spot.x >= window.left && spot.x + image.width <= window.right + 1 &&
           spot.y >= window.bottom && spot.y + image.height <= window.top + 1;
}

} // namespace

PageGrid::PageGrid(const PageProblem& problem, Index columns, Index rows, Index singles,
                   Index factor)
    : problem_(&problem), columns_(columns), rows_(rows), singles_(singles),
      factor_(factor), starts_{part_starts(columns, 0), part_starts(rows, 1)} {}

std::vector<Index> PageGrid::part_starts(Index pages, int axis) const {
    const double step = problem_->page.step()[axis];
    const double cell = factor_ * problem_->cell;
    std::vector<Index> starts{0};
    for (Index page = 0; page + 1 < pages; ++page) {
        const double low = (page + 1) * step + inset - reach;
        const double high = (page + 1) * step + tile_overlap + inset + reach;
        const bool is_rounded = factor_ > 1;
        starts.push_back(
            static_cast<Index>(is_rounded ? std::round(low / cell) : std::ceil(low / cell)));
        starts.push_back(
            static_cast<Index>(is_rounded ? std::round(high / cell) : std::floor(high / cell)));
    }
    starts.push_back(static_cast<Index>(std::ceil((pages * step + tile_overlap + inset) / cell)));
    return starts;
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

pack::Window PageGrid::shown(Index page) const {
    const auto range = [&](Index k, const std::vector<Index>& starts) {
        const std::size_t part = 2 * at(k);
        return std::array<Index, 2>{starts[part - (part > 0 ? 1 : 0)],
                                    starts[std::min(part + 2, starts.size() - 1)] - 1};
    };
    const auto x = range(page % columns_, starts_[0]);
    const auto y = range(page / columns_, starts_[1]);
    return {x[0], x[1], y[0], y[1]};
}

pack::Window PageGrid::own(Index page) const {
    const std::size_t column = 2 * at(page % columns_);
    const std::size_t row = 2 * at(page / columns_);
    return {starts_[0][column], starts_[0][column + 1] - 1, starts_[1][row],
            starts_[1][row + 1] - 1};
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
        for (Index page = 0; page < glued() && y >= ring && y - ring <= all.top; ++page) {
            const pack::Window w = shown(page);
            if (is_open[at(page)] != 0 && y - ring >= w.bottom && y - ring <= w.top)
                std::fill(is_free.begin() + ring + w.left,
                          is_free.begin() + ring + std::min(w.right, all.right) + 1,
                          std::uint8_t{1});
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

std::vector<std::vector<pack::Window>> PageGrid::windows(const std::vector<std::uint8_t>& is_open,
                                                         const pack::ChartCells& closed,
                                                         const pack::Spot& spot) const {
    std::vector<pack::Window> clear_ones;
    pack::Window around{sheet().right, 0, sheet().top, 0}; // open pages of the sheet
    for (Index page = 0; page < pages(); ++page) {
        if (is_open[at(page)] == 0)
            continue;
        clear_ones.push_back(clear(page));
        if (page >= glued())
            continue;
        const pack::Window part = shown(page);
        around = {std::min(around.left, part.left), std::max(around.right, part.right),
                  std::min(around.bottom, part.bottom), std::max(around.top, part.top)};
    }
    around.right = std::min(around.right, sheet().right);
    around.top = std::min(around.top, sheet().top);
    std::vector<std::vector<pack::Window>> windows;
    for (const std::uint8_t large : problem_->is_large)
        windows.push_back(large != 0 ? std::vector<pack::Window>{around} : clear_ones);
    windows.push_back({{spot.x, spot.x + closed.width - 1, spot.y, spot.y + closed.height - 1}});
    return windows;
}

Index PageGrid::page_of(const pack::ChartCells& image, const pack::Spot& spot) const {
    for (Index page = 0; page < pages(); ++page)
        if (is_within(clear(page), image, spot))
            return page;
    return -1;
}

void PageGrid::count(const pack::ChartCells& image, const pack::Spot& spot,
                     std::vector<Index>& parts) const {
    const auto& [across, up] = starts_;
    const Index width = parts_of(columns_);
    for (const pack::CellRun& run : image.runs) {
        const Index y = run.row + spot.y;
        const auto row =
            static_cast<Index>(std::upper_bound(up.begin(), up.end(), y) - up.begin()) - 1;
        if (row < 0 || row >= parts_of(rows_))
            continue;
        const Index first = run.first + spot.x;
        const Index last = run.last + spot.x;
        for (Index column = 0; column < width && across[at(column)] < last; ++column)
            parts[at(row * width + column)] +=
                std::max(Index{0}, std::min(across[at(column + 1)], last) -
                                       std::max(across[at(column)], first));
    }
}

PageCover PageGrid::cover(const std::vector<const pack::ChartCells*>& images,
                          const pack::Layout& spots) const {
    PageCover cover;
    cover.cells.assign(at(pages()), 0);
    std::vector<Index> parts = empty_parts();
    for (std::size_t i = 0; i < images.size(); ++i) {
        const Index page = problem_->is_large[i] != 0 ? -1 : page_of(*images[i], spots[i]);
        if (page >= glued())
            cover.cells[at(page)] += images[i]->count;
        else
            count(*images[i], spots[i], parts);
    }
    cover.owner = cover_parts(columns_, rows_, parts);
    for (std::size_t part = 0; part < parts.size(); ++part)
        if (cover.owner[part] >= 0)
            cover.cells[at(cover.owner[part])] += parts[part];
    return cover;
}

Index PageGrid::least_pages(const pack::ChartCells& image, const pack::Spot& spot) const {
    std::vector<Index> parts = empty_parts();
    count(image, spot, parts);
    std::vector<Index> owner = cover_parts(columns_, rows_, parts);
    owner.push_back(-1); // where nothing is printed
    std::sort(owner.begin(), owner.end());
    return static_cast<Index>(std::unique(owner.begin(), owner.end()) - owner.begin()) - 1;
}

std::vector<Index> PageGrid::pages_of(const pack::ChartCells& image, const pack::Spot& spot,
                                      const PageCover& cover) const {
    std::vector<Index> parts = empty_parts();
    count(image, spot, parts);
    std::vector<Index> pages;
    for (std::size_t part = 0; part < parts.size(); ++part)
        if (parts[part] > 0)
            pages.push_back(cover.owner[part]);
    std::sort(pages.begin(), pages.end());
    pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
    return pages;
}

} // namespace devseg::sheet
