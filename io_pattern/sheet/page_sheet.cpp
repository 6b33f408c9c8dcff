#include "sheet/page_sheet.h"

#include <cstdint>

namespace devseg::sheet {

namespace {

struct Tuning {
    int places = 12;                    // of a piece in a page, in each direction
    std::size_t most_pages = 48;        // of a piece whose places are looked at one by one
    std::size_t more_pages = 1;         // than the fewest, of places that are kept,
    std::size_t share_of_more = 5;      // and one of so many besides
    unsigned only_known = 2;            // one of so many attempts looks at others as well
    std::size_t tried = 400;            // of the known places, evenly from all of them
    std::size_t most_tests = 200;       // of places, whether others are in the way
    std::size_t work_of_candidate = 10; // in rows of images that are compared
    std::int64_t work_of_row = 40;      // that is put on a sheet
};
constexpr Tuning tuning;

// The first page in one direction that shows all up to a cell; margins of images do not count.
Index page_at(double mm, double step) {
    return std::max(Index{0}, static_cast<Index>(std::ceil((mm - tile_overlap) / step - 1e-9)) - 1);
}

// The pages that a piece needs on a sheet of so many columns, and how many of its cells lie on
// each.
std::vector<std::pair<Index, Index>> pages_of(const PageProblem& problem, Index columns,
                                              const pack::ChartCells& image,
                                              const pack::Spot& spot) {
    const double cell = problem.cell;
    const double inset = border_clearance; // from the left end of an image to its piece
    const Vec2 step = problem.page.step();
    const Index rows = page_at(cell * (spot.y + image.height) + inset, step.y()) + 1;
    std::vector<Index> counts(at(rows * columns), 0);
    for (const pack::CellRun& run : image.runs) {
        const double height = cell * (run.row + 0.5); // in the image
        if (height < 0.5 * piece_gap || height > cell * image.height - 0.5 * piece_gap)
            continue;
        const double y = cell * spot.y + height + inset - 0.5 * piece_gap;
        const double left = cell * (spot.x + run.first) + inset;
        const double right = std::max(left, cell * (spot.x + run.last) + inset - piece_gap);
        const Index row = page_at(y, step.y());
        const Index last = std::min(columns - 1, page_at(right, step.x()));
        for (Index c = std::min(last, page_at(left, step.x())); c <= last; ++c) {
            const double end = std::min(right, (c + 1) * step.x() + tile_overlap);
            const double begin = std::max(left, c * step.x() + tile_overlap);
            const auto cells = 1 + static_cast<Index>(std::max(0.0, end - begin) / cell);
            counts[at(row * columns + c)] += cells;
        }
    }
    std::vector<std::pair<Index, Index>> pages;
    for (std::size_t page = 0; page < counts.size(); ++page)
        if (counts[page] > 0)
            pages.emplace_back(static_cast<Index>(page), counts[page]);
    return pages;
}

} // namespace

std::vector<Footprint> find_footprints(const PageProblem& problem,
                                       const std::vector<pack::FitImage>& poses) {
    const Vec2 step = problem.page.step();
    std::vector<Footprint> result;
    const auto most_of = [](std::size_t fewest_pages) {
        return fewest_pages + tuning.more_pages + fewest_pages / tuning.share_of_more;
    };
    std::size_t fewest = tuning.most_pages;
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
        const auto columns =
            static_cast<Index>(problem.cell * poses[pose].cells.width / step.x()) + 3;
        for (int i = -1; i < tuning.places; ++i)
            for (int j = -1; j < tuning.places; ++j) {
                Footprint f;
                f.pose = pose;
                f.at_border = {i < 0, j < 0};
                f.offset = Vec2(i < 0 ? 0.0 : tile_overlap + step.x() * i / tuning.places,
                                j < 0 ? 0.0 : tile_overlap + step.y() * j / tuning.places);
                const pack::Spot spot{pose, problem.cells_up(f.offset.x()),
                                      problem.cells_up(f.offset.y())};
                for (const auto& [page, cells] :
                     pages_of(problem, columns, poses[pose].cells, spot))
                    f.pages.push_back({page % columns, page / columns});
                for (const auto& page : f.pages)
                    f.across = std::max(f.across, page[0] + 1);
                fewest = std::min(fewest, f.pages.size());
                if (f.pages.size() <= most_of(fewest))
                    result.push_back(std::move(f));
            }
    }
    result.erase(
        std::remove_if(result.begin(), result.end(),
                       [&](const Footprint& f) { return f.pages.size() > most_of(fewest); }),
        result.end());
    return result;
}

bool PageSheet::put_on_page(const std::vector<pack::FitImage>& poses,
                            const std::vector<std::size_t>& chosen, pack::Spot& spot) {
    for (Index page = 0; page < static_cast<Index>(covered_.size()); ++page) {
        if (!is_used(page))
            continue;
        pack::FitWindow window = inner_window(page % columns_, page / columns_);
        bool found = false;
        for (const std::size_t pose : chosen) {
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
                                          const std::vector<Footprint>& footprints,
                                          std::minstd_rand* random) {
    LargePlace best;
    if (random != nullptr && !footprints.empty() && (*random)() % tuning.only_known != 0) {
        look_at(poses, footprints, random, best);
        if (best.found)
            return best;
    }
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
    look_at(poses, footprints, random, best);
    return best;
}

void PageSheet::take(const pack::FitImage& image, const pack::Spot& spot, double area) {
    cells_.take(image, spot);
    *work_ += tuning.work_of_row * image.cells.height;
    area_ += area;
    for (const auto& [page, cells] : pages_of(*problem_, columns_, image.cells, spot)) {
        if (page >= static_cast<Index>(covered_.size()))
            covered_.resize(at((page / columns_ + 1) * columns_), 0);
        covered_[at(page)] += cells;
    }
}

bool PageSheet::needs_emptiest(const pack::FitImage& image, const pack::Spot& spot) const {
    const Index fewest = fewest_cells();
    const auto pages = pages_of(*problem_, columns_, image.cells, spot);
    return std::any_of(pages.begin(), pages.end(),
                       [&](const auto& page) { return covered_[at(page.first)] == fewest; });
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
    for (const auto& [page, cells] : pages_of(*problem_, columns_, poses[pose].cells, place.spot))
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

void PageSheet::look_at(const std::vector<pack::FitImage>& poses,
                        const std::vector<Footprint>& footprints, std::minstd_rand* random,
                        LargePlace& best) {
    struct Candidate {
        Index new_pages;
        std::uint_fast32_t rank;
        const Footprint* footprint;
        Index column, row;
    };
    std::vector<Candidate> candidates;
    const std::size_t all = footprints.size();
    const std::size_t count = random != nullptr ? std::min(all, tuning.tried) : all;
    const std::size_t start = random != nullptr && all > 0 ? (*random)() % all : 0;
    for (std::size_t k = 0; k < count; ++k) {
        const Footprint& f = footprints[(start + k * all / count) % all];
        const Index last_row = f.at_border[1] ? 0 : rows();
        const Index last_column = f.at_border[0] ? 0 : columns_ - f.across;
        for (Index row = 0; row <= last_row; ++row)
            for (Index column = 0; column <= last_column && column + f.across <= columns_;
                 ++column) {
                const auto news = static_cast<Index>(
                    std::count_if(f.pages.begin(), f.pages.end(), [&](const auto& page) {
                        return !is_used((row + page[1]) * columns_ + column + page[0]);
                    }));
                if (!best.found || news <= best.new_pages)
                    candidates.push_back(
                        {news, random != nullptr ? (*random)() : 0, &f, column, row});
            }
    }
    *work_ += static_cast<std::int64_t>(tuning.work_of_candidate * candidates.size());
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        return std::pair(a.new_pages, a.rank) < std::pair(b.new_pages, b.rank);
    });
    if (candidates.size() > tuning.most_tests)
        candidates.resize(tuning.most_tests);
    for (const Candidate& c : candidates) {
        if (best.found && c.new_pages >= best.new_pages + (random != nullptr ? 1 : 0))
            break;
        const Vec2 place =
            c.footprint->offset + Vec2(c.column, c.row).cwiseProduct(problem_->page.step());
        const pack::ChartCells& image = poses[c.footprint->pose].cells;
        const Index x = problem_->cells_up(place.x());
        const Index y = problem_->cells_up(place.y());
        LargePlace here;
        look(poses, c.footprint->pose, {x, x + image.width, y, y + image.height}, here);
        if (here.found && (!best.found || here.new_pages <= best.new_pages)) {
            best = here;
            return;
        }
    }
}

} // namespace devseg::sheet
