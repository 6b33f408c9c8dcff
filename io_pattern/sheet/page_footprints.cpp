#include "sheet/page_footprints.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace devseg::sheet {

namespace {

struct Tuning {
    double pitch = 3.0;            // mm between the places that are looked at
    std::size_t most_places = 90;  // in one direction: pages may be large
    std::size_t more_pages = 2;    // than the fewest, of places that are kept,
    std::size_t share_of_more = 5; // and one of so many besides
    std::size_t most_kept = 24;    // places with the same pages, evenly from all of them
    std::size_t most_sets = 4000;  // of pages: a piece of tens of pages has as many as places
};
constexpr Tuning tuning;

// The first page in one direction that shows all up to a cell; margins of images do not count.
Index page_at(double mm, double step) {
    return std::max(Index{0}, static_cast<Index>(std::ceil((mm - tile_overlap) / step - 1e-9)) - 1);
}

// From the left end of an image to its piece, and to the middle of its first row.
constexpr double inset = border_clearance;
constexpr double row_inset = border_clearance - 0.5 * piece_gap;

// Whether a row of an image is more than the margin around its piece.
bool is_in_piece(const PageProblem& problem, const pack::ChartCells& image, Index row) {
    const double height = problem.cell * (row + 0.5);
    return height >= 0.5 * piece_gap && height <= problem.cell * image.height - 0.5 * piece_gap;
}

std::pair<double, double> ends_of(const PageProblem& problem, const pack::CellRun& run, Index x) {
    const double left = problem.cell * (x + run.first) + inset;
    return {left, std::max(left, problem.cell * (x + run.last) + inset - piece_gap)};
}

// All columns of pages that the rows of an image need, for one place in x.
class Columns {
public:
    Columns(const PageProblem& problem, const pack::ChartCells& image, Index x)
        : problem_(problem), height_(at(image.height)) {
        const double step = problem.page.step().x();
        for (const pack::CellRun& run : image.runs) {
            if (!is_in_piece(problem, image, run.row))
                continue;
            const auto [left, right] = ends_of(problem, run, x);
            const Index last = page_at(right, step);
            while (static_cast<Index>(next_.size()) <= last)
                next_.emplace_back(height_ + 1, image.height);
            for (Index c = page_at(left, step); c <= last; ++c)
                next_[at(c)][at(run.row)] = run.row;
        }
        for (std::vector<Index>& column : next_)
            for (std::size_t row = height_; row-- > 0;)
                column[row] = std::min(column[row], column[row + 1]);
    }

    std::vector<PageSpot> pages(Index y) const {
        std::vector<PageSpot> result;
        const double step = problem_.page.step().y();
        for (Index row = 0, from = 0; from < static_cast<Index>(height_); ++row) {
            // The first row of the image that the pages of this row do not show.
            const double end = tile_overlap + (row + 1) * (step + 1e-9) - row_inset;
            const Index to =
                std::clamp(static_cast<Index>(std::floor(end / problem_.cell - y - 0.5)) + 1, from,
                           static_cast<Index>(height_));
            for (std::size_t c = 0; c < next_.size(); ++c)
                if (next_[c][at(from)] < to)
                    result.push_back({static_cast<Index>(c), row});
            from = to;
        }
        return result;
    }

private:
    const PageProblem& problem_;
    std::size_t height_;
    std::vector<std::vector<Index>> next_; // the next row of the image that needs the column
};

// Offsets in one direction: in the strip at the border, then all over a page.
std::vector<double> offsets_of(double step) {
    const auto count =
        std::min(tuning.most_places, static_cast<std::size_t>(std::ceil(step / tuning.pitch)));
    std::vector<double> offsets{0.0};
    for (std::size_t i = 0; i < count; ++i)
        offsets.push_back(tile_overlap +
                          step * static_cast<double>(i) / static_cast<double>(count));
    return offsets;
}

// Footprints by their pages.
class Collection {
public:
    void add(std::vector<PageSpot> pages, const PagePlace& place) {
        const std::array<bool, 2> at_border{place.offset.x() == 0.0, place.offset.y() == 0.0};
        if (pages.empty() || pages.size() > most(std::min(fewest_, pages.size())))
            return;
        fewest_ = std::min(fewest_, pages.size());
        Known& known = known_[{pages.size(), at_border, pages}];
        // As many as are wanted, evenly: every second one goes when there are twice as many.
        if (known.seen++ % known.every == 0)
            known.places.push_back(place);
        if (known.places.size() < 2 * tuning.most_kept)
            return;
        for (std::size_t i = 0; i < tuning.most_kept; ++i)
            known.places[i] = known.places[2 * i];
        known.places.resize(tuning.most_kept);
        known.every *= 2;
    }

    std::vector<Footprint> result() const {
        std::vector<Footprint> footprints;
        const std::size_t every = 1 + known_.size() / tuning.most_sets;
        std::size_t k = 0;
        for (const auto& [key, known] : known_) {
            if (std::get<0>(key) > most(fewest_) || k++ % every != 0)
                continue;
            Footprint f;
            f.at_border = std::get<1>(key);
            f.pages = std::get<2>(key);
            f.places = known.places;
            for (const PageSpot& page : f.pages) {
                f.across = std::max(f.across, page[0] + 1);
                f.up = std::max(f.up, page[1] + 1);
            }
            footprints.push_back(std::move(f));
        }
        return footprints;
    }

private:
    struct Known {
        std::size_t seen = 0;
        std::size_t every = 1;
        std::vector<PagePlace> places;
    };

    static std::size_t most(std::size_t fewest) {
        return fewest + tuning.more_pages + fewest / tuning.share_of_more;
    }

    std::size_t fewest_ = static_cast<std::size_t>(-1) / 2;
    std::map<std::tuple<std::size_t, std::array<bool, 2>, std::vector<PageSpot>>, Known> known_;
};

} // namespace

std::vector<std::pair<PageSpot, Index>>
pages_of(const PageProblem& problem, const pack::ChartCells& image, const pack::Spot& spot) {
    const double cell = problem.cell;
    const Vec2 step = problem.page.step();
    // Runs come row by row: the columns of one row of pages at a time.
    std::vector<std::pair<PageSpot, Index>> pages;
    std::vector<Index> counts;
    Index row = 0;
    const auto finish_row = [&] {
        for (std::size_t c = 0; c < counts.size(); ++c)
            if (counts[c] > 0)
                pages.push_back({{static_cast<Index>(c), row}, counts[c]});
        counts.assign(counts.size(), 0);
    };
    for (const pack::CellRun& run : image.runs) {
        if (!is_in_piece(problem, image, run.row))
            continue;
        const Index here = page_at(cell * (spot.y + run.row + 0.5) + row_inset, step.y());
        if (here != row)
            finish_row();
        row = here;
        const auto [left, right] = ends_of(problem, run, spot.x);
        const Index last = page_at(right, step.x());
        if (last >= static_cast<Index>(counts.size()))
            counts.resize(at(last) + 1, 0);
        for (Index c = page_at(left, step.x()); c <= last; ++c) {
            const double end = std::min(right, (c + 1) * step.x() + tile_overlap);
            const double begin = std::max(left, c * step.x() + tile_overlap);
            counts[at(c)] += 1 + static_cast<Index>(std::max(0.0, end - begin) / cell);
        }
    }
    finish_row();
    return pages;
}

std::vector<Footprint> find_footprints(const PageProblem& problem,
                                       const std::vector<pack::FitImage>& poses) {
    const Vec2 step = problem.page.step();
    const std::vector<double> xs = offsets_of(step.x());
    const std::vector<double> ys = offsets_of(step.y());
    Collection found;
    for (std::size_t pose = 0; pose < poses.size(); ++pose)
        for (const double x : xs) {
            const Columns columns(problem, poses[pose].cells, problem.cells_up(x));
            for (const double y : ys)
                found.add(columns.pages(problem.cells_up(y)), {pose, Vec2(x, y)});
        }
    return found.result();
}

} // namespace devseg::sheet
