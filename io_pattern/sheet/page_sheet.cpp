#include "sheet/page_sheet.h"

namespace devseg::sheet {

bool PageSheet::put_on_page(const std::vector<pack::FitImage>& poses, pack::Spot& spot) {
    for (Index page = 0; page < static_cast<Index>(covered_.size()); ++page) {
        if (!is_used(page))
            continue;
        pack::FitWindow window = inner_window(page % columns_, page / columns_);
        bool found = false;
        for (std::size_t pose = 0; pose < poses.size(); ++pose) {
            pack::Spot here;
            if (!find(poses[pose], window, here))
                continue;
            found = true;
            spot = {pose, here.x, here.y};
            window.top = here.y + poses[pose].cells.height - 1;
        }
        if (found)
            return true;
    }
    return false;
}

PageSheet::LargePlace PageSheet::place_of(const std::vector<pack::FitImage>& poses,
                                          const std::vector<std::size_t>& chosen,
                                          std::minstd_rand* random) {
    LargePlace best;
    for (const std::size_t pose : chosen) {
        const pack::ChartCells& image = poses[pose].cells;
        const Index across = pages_for(image.width, problem_->columns, step(0));
        const Index up = pages_for(image.height, problem_->rows, step(1));
        for (Index row = 0; row <= rows(); ++row)
            for (Index column = 0; column + across <= columns_; ++column) {
                pack::FitWindow window = block(column, row, across, up);
                if (random != nullptr) {
                    window.left += part((*random)(), window.right - window.left - image.width);
                    window.from += part((*random)(), window.top - window.from - image.height);
                }
                look(poses, pose, window, best);
            }
        if (across <= columns_) // anywhere, across more pages than it is large
            look(poses, pose, block(0, 0, columns_, rows() + up), best);
    }
    return best;
}

void PageSheet::take(const pack::FitImage& image, const pack::Spot& spot, double area) {
    cells_.take(image, spot);
    area_ += area;
    for (const auto& [page, cells] : pages_under(image.cells, spot)) {
        if (page >= static_cast<Index>(covered_.size()))
            covered_.resize(at((page / columns_ + 1) * columns_), 0);
        covered_[at(page)] += cells;
    }
}

PatternSheet PageSheet::result() const {
    PatternSheet sheet;
    const PageFormat& page = problem_->page;
    sheet.columns = columns_;
    sheet.rows = rows();
    sheet.size = page.size + Vec2(sheet.columns - 1, sheet.rows - 1).cwiseProduct(page.step());
    return sheet;
}

bool PageSheet::find(const pack::FitImage& image, const pack::FitWindow& window, pack::Spot& spot) {
    const bool found = cells_.find(image, window, spot);
    const Index last = found ? spot.y : window.top - image.cells.height;
    *work_ += std::int64_t{std::max(1, last - window.from + 1)} *
              static_cast<std::int64_t>(image.runs.size());
    return found;
}

void PageSheet::look(const std::vector<pack::FitImage>& poses, std::size_t pose,
                     const pack::FitWindow& window, LargePlace& best) {
    LargePlace place;
    if (!find(poses[pose], window, place.spot))
        return;
    place.found = true;
    place.spot.pose = pose;
    place.top = place.spot.y + poses[pose].cells.height;
    for (const auto& [page, cells] : pages_under(poses[pose].cells, place.spot))
        place.new_pages += is_used(page) ? 0 : 1;
    if (place.is_better_than(best))
        best = place;
}

pack::FitWindow PageSheet::block(Index column, Index row, Index across, Index up) const {
    const Vec2 low = Vec2(column, row).cwiseProduct(problem_->page.step());
    const Vec2 high = Vec2(column + across - 1, row + up - 1).cwiseProduct(problem_->page.step());
    return {problem_->cells_up(low.x()), problem_->cells_down(high.x()) + problem_->columns,
            problem_->cells_up(low.y()), problem_->cells_down(high.y()) + problem_->rows};
}

pack::FitWindow PageSheet::inner_window(Index column, Index row) const {
    pack::FitWindow window = block(column, row, 1, 1);
    const Index strip = problem_->cells_up(tile_overlap);
    window.left += column > 0 ? strip : 0;
    window.right -= column + 1 < columns_ ? strip : 0;
    window.from += row > 0 ? strip : 0;
    window.top -= row + 1 < rows() ? strip : 0;
    return window;
}

std::vector<std::pair<Index, Index>> PageSheet::pages_under(const pack::ChartCells& image,
                                                            const pack::Spot& spot) const {
    std::vector<std::pair<Index, Index>> pages;
    const double cell = problem_->cell;
    const double inset = border_clearance; // from the left end of an image to its piece
    const Vec2 step = problem_->page.step();
    for (const pack::CellRun& run : image.runs) {
        const double height = cell * (run.row + 0.5); // in the image
        if (height < 0.5 * piece_gap || height > cell * image.height - 0.5 * piece_gap)
            continue;
        const double y = cell * spot.y + height + inset - 0.5 * piece_gap;
        const double left = cell * (spot.x + run.first) + inset;
        const double right = std::max(left, cell * (spot.x + run.last) + inset - piece_gap);
        const Index row = page_at(y, step.y());
        const Index last = std::min(columns_ - 1, page_at(right, step.x()));
        for (Index c = std::min(last, page_at(left, step.x())); c <= last; ++c) {
            const double end = std::min(right, (c + 1) * step.x() + tile_overlap);
            const double begin = std::max(left, c * step.x() + tile_overlap);
            const auto cells = 1 + static_cast<Index>(std::max(0.0, end - begin) / cell);
            const Index page = row * columns_ + c;
            const auto known = std::find_if(pages.begin(), pages.end(),
                                            [&](const auto& p) { return p.first == page; });
            if (known == pages.end())
                pages.emplace_back(page, cells);
            else
                known->second += cells;
        }
    }
    return pages;
}

} // namespace devseg::sheet
