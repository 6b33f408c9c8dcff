#include "sheet/page_sheet.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace devseg::sheet {

namespace {

struct Tuning {
    std::size_t most_footprints = 600; // that are looked at for one piece, evenly from all
    int tests = 12;                    // of places with the same pages
    int most_tests = 3000;             // of one piece on one sheet
    std::int64_t work_of_row = 40;     // that is put on a sheet
    std::int64_t work_of_test = 20;    // of one place, and of one set of pages
    Index longest_slide = 16;          // cells at a time, until others are in the way
    int most_slides = 8;               // of one length
    std::int64_t work_of_slide = 1000;
};
constexpr Tuning tuning;

} // namespace

Index PageSheet::page_count() const {
    return static_cast<Index>(covered_.size()) -
           static_cast<Index>(std::count(covered_.begin(), covered_.end(), 0));
}

bool PageSheet::is_on(const pack::FitImage& image, const pack::Spot& spot, Index page) const {
    const PageSpot wanted{page % columns_, page / columns_};
    for (const auto& [place, cells] : pages_of(*problem_, image.cells, spot))
        if (place == wanted)
            return true;
    return false;
}

std::optional<pack::Spot> PageSheet::place_on_page(const std::vector<pack::FitImage>& poses,
                                                   const std::vector<std::size_t>& chosen,
                                                   Index page) {
    const PageProblem& problem = *problem_;
    const Index column = page % columns_;
    const Index row = page / columns_;
    const Vec2 low = Vec2(column, row).cwiseProduct(problem.page.step());
    const Index strip = problem.cells_up(tile_overlap);
    pack::FitWindow window{problem.cells_up(low.x()), problem.cells_down(low.x()) + problem.columns,
                           problem.cells_up(low.y()), problem.cells_down(low.y()) + problem.rows};
    // Clear of the strips that it shares with pages beside it.
    window.left += column > 0 ? strip : 0;
    window.right -= column + 1 < columns_ ? strip : 0;
    window.from += row > 0 ? strip : 0;
    window.top -= row + 1 < rows() ? strip : 0;
    std::optional<pack::Spot> found;
    for (const std::size_t pose : chosen) {
        pack::Spot here;
        const bool is_free = cells_.find(poses[pose], window, here);
        const Index last = is_free ? here.y : window.top - poses[pose].cells.height;
        *work_ += std::int64_t{std::max(1, last - window.from + 1)} *
                  static_cast<std::int64_t>(poses[pose].runs.size()) / 2; // few rows to the end
        if (!is_free)
            continue;
        found = {pose, here.x, here.y};
        window.top = here.y + poses[pose].cells.height - 1;
    }
    return found;
}

std::optional<pack::Spot> PageSheet::place_large(const std::vector<pack::FitImage>& poses,
                                                 const std::vector<Footprint>& footprints,
                                                 std::minstd_rand& random, Index& limit) {
    struct Candidate {
        Index new_pages;
        std::uint_fast32_t rank;
        const Footprint* footprint;
        Index column, row;
    };
    std::vector<Candidate> candidates;
    const std::size_t all = footprints.size();
    const std::size_t count = std::min(all, tuning.most_footprints);
    const std::size_t start = random() % all;
    for (std::size_t k = 0; k < count; ++k) {
        const Footprint& f = footprints[(start + k * all / count) % all];
        const Index last_row = f.at_border[1] ? 0 : rows();
        const Index last_column = f.at_border[0] ? 0 : columns_ - f.across;
        for (Index row = 0; row <= last_row; ++row)
            for (Index column = 0; column <= std::min(last_column, columns_ - f.across); ++column) {
                const auto news = static_cast<Index>(
                    std::count_if(f.pages.begin(), f.pages.end(), [&](const PageSpot& page) {
                        return !is_used((row + page[1]) * columns_ + column + page[0]);
                    }));
                *work_ += tuning.work_of_test;
                if (news < limit)
                    candidates.push_back({news, random(), &f, column, row});
            }
    }
    std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        return std::tuple(a.new_pages, a.rank, a.footprint, a.column, a.row) <
               std::tuple(b.new_pages, b.rank, b.footprint, b.column, b.row);
    });
    int tests = 0;
    for (const Candidate& c : candidates)
        for (int k = 0; k < tuning.tests && tests < tuning.most_tests; ++k) {
            const std::vector<PagePlace>& places = c.footprint->places;
            const pack::Spot spot =
                problem_->spot_of(places[random() % places.size()], c.column, c.row);
            ++tests;
            *work_ += tuning.work_of_test;
            if (!cells_.is_free(poses[spot.pose], spot))
                continue;
            // Pages further on, cells are rounded in another way.
            const Index news = new_pages(poses[spot.pose], spot);
            if (news > c.new_pages)
                continue;
            limit = news;
            return slid(poses[spot.pose], spot, random);
        }
    return std::nullopt;
}

Index PageSheet::new_pages(const pack::FitImage& image, const pack::Spot& spot) const {
    Index news = 0;
    for (const auto& [page, cells] : pages_of(*problem_, image.cells, spot))
        news += page[0] >= columns_ || !is_used(page[1] * columns_ + page[0]) ? 1 : 0;
    return news;
}

// Moved in one of four directions as far as nothing is in the way and no more pages are needed:
// what is left beside it is in one part.
pack::Spot PageSheet::slid(const pack::FitImage& image, pack::Spot spot,
                           std::minstd_rand& random) const {
    const Index limit = new_pages(image, spot);
    const auto ways = random();
    for (Index step = tuning.longest_slide; step > 0; step /= 2)
        for (const int axis : {0, 1})
            for (int moved = 0; moved < tuning.most_slides; ++moved) {
                pack::Spot next = spot;
                (axis == 0 ? next.x : next.y) += (ways >> axis & 1U) != 0 ? step : -step;
                *work_ += tuning.work_of_slide;
                if (next.x < 0 || next.y < 0 || !cells_.is_free(image, next) ||
                    new_pages(image, next) > limit)
                    break;
                spot = next;
            }
    return spot;
}

void PageSheet::take(const pack::FitImage& image, const pack::Spot& spot, double area) {
    cells_.take(image, spot);
    *work_ += tuning.work_of_row * image.cells.height;
    area_ += area;
    for (const auto& [page, cells] : pages_of(*problem_, image.cells, spot)) {
        // A cell of the margin may lie beside the last column.
        const Index number = page[1] * columns_ + std::min(page[0], columns_ - 1);
        if (number >= static_cast<Index>(covered_.size()))
            covered_.resize(at((page[1] + 1) * columns_), 0);
        covered_[at(number)] += cells;
    }
}

PageSpot PageSheet::empty_margin() const {
    PageSpot margin{columns_, rows()};
    for (Index page = 0; page < static_cast<Index>(covered_.size()); ++page)
        if (is_used(page)) {
            margin[0] = std::min(margin[0], page % columns_);
            margin[1] = std::min(margin[1], page / columns_);
        }
    return margin;
}

PatternSheet PageSheet::result() const {
    PatternSheet sheet;
    const PageSpot margin = empty_margin();
    Index last = 0;
    for (Index page = 0; page < static_cast<Index>(covered_.size()); ++page)
        last = is_used(page) ? std::max(last, page % columns_) : last;
    const PageFormat& page = problem_->page;
    sheet.columns = last + 1 - margin[0];
    sheet.rows = rows() - margin[1];
    sheet.size = page.size + Vec2(sheet.columns - 1, sheet.rows - 1).cwiseProduct(page.step());
    return sheet;
}

} // namespace devseg::sheet
