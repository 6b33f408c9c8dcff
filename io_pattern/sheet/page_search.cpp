#include <cstdio>
#include <cstdlib>
#include "sheet/page_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/pack/nest.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    Index factor = getenv("FA") ? atoi(getenv("FA")) : 5;           // cells that make one coarse cell, to a side
    int searches = 4;           // on sheets of other widths
    double work = getenv("WK") ? atof(getenv("WK")) : 8e9;        // cells that all searches look at, some seconds
    double fine_work = getenv("FW") ? atof(getenv("FW")) : 1.0e8;   // to bring what was found to the problem's cells
    double covered = 0.6;      // of the pages of a sheet, as large pieces lie at first
    double full = 0.9;          // share of the paper that no nesting covers
    double almost_empty = 0.05; // of a page: it is hardly worth the paper
    int attempts = 8;           // on larger and larger sheets, until pieces lie apart
};
static const Tuning tuning;
static const pack::SeparationOptions coarse_moves{0, std::size_t(getenv("CP")?atoi(getenv("CP")):8), getenv("PA")?atoi(getenv("PA")):30};
constexpr double fine_turn = 1.5 * pi / 180.0;
constexpr int fine_turns = 2; // to each side
constexpr pack::SeparationOptions fine_moves{7, 2 * fine_turns + 1, 40};

// Where pieces lie on a grid of coarse cells.
struct CoarseLayout {
    Index columns = 1;
    Index rows = 0;
    Index singles = 0;
    pack::Layout spots;
    Index goal = 0; // pages, and once more those that are almost empty
};

using Windows = std::vector<std::vector<pack::Window>>;

// On the pages that are open; the last window is that of what is closed.
Windows windows_of(const PageProblem& problem, const PageGrid& grid,
                   const std::vector<std::uint8_t>& is_open, const pack::ChartCells& closed,
                   const pack::Spot& spot) {
    std::vector<pack::Window> clear;
    for (Index page = 0; page < grid.pages(); ++page)
        if (is_open[at(page)] != 0)
            clear.push_back(grid.clear(page));
    Windows windows;
    for (const std::uint8_t large : problem.is_large)
        windows.push_back(large != 0 ? std::vector<pack::Window>{grid.sheet()} : clear);
    windows.push_back(
        {{spot.x, spot.x + closed.width - 1, spot.y, spot.y + closed.height - 1}});
    return windows;
}

bool is_within(const pack::Window& window, const pack::ChartCells& image, const pack::Spot& spot) {
    return spot.x >= window.left && spot.x + image.width <= window.right + 1 &&
           spot.y >= window.bottom && spot.y + image.height <= window.top + 1;
}

Index page_of(const PageGrid& grid, const pack::ChartCells& image, const pack::Spot& spot) {
    for (Index page = 0; page < grid.pages(); ++page)
        if (is_within(grid.clear(page), image, spot))
            return page;
    return -1;
}

class Search {
public:
    Search(const PageProblem& problem, const std::vector<pack::ChartPoses>& poses, Index columns,
           std::uint64_t seed, double work)
        : problem_(problem), poses_(poses), columns_(columns), seed_(seed), work_(static_cast<std::int64_t>(work)) {}

    // All layouts that were found, each better than the one before.
    const std::vector<CoarseLayout>& found() const { return found_; }
    std::int64_t left() const { return work_; }

    void run(const Progress& progress) {
        if (!begin(progress))
            return;
        while (work_ > 0 && !is_best() && close_some(progress))
            ;
    }

private:
    bool is_best() const {
        const double total = std::accumulate(problem_.area.begin(), problem_.area.end(), 0.0);
        return found_.back().goal <= std::ceil(total / (tuning.full * problem_.page_area()));
    }

    PageGrid grid_of(const CoarseLayout& layout) const {
        return {problem_, layout.columns, layout.rows, layout.singles, tuning.factor};
    }

    std::vector<Index> covered(const CoarseLayout& layout) const {
        const PageGrid grid = grid_of(layout);
        std::vector<Index> cells(at(grid.pages()), 0);
        for (std::size_t i = 0; i < poses_.size(); ++i) {
            const pack::ChartCells& image = poses_[i][layout.spots[i].pose];
            if (problem_.is_large[i] != 0)
                grid.count(image, layout.spots[i], cells);
            else
                cells[at(page_of(grid, image, layout.spots[i]))] += image.count;
        }
        return cells;
    }

    void keep(CoarseLayout layout) {
        const double cell = tuning.factor * problem_.cell;
        const double least = tuning.almost_empty * problem_.page_area() / (cell * cell);
        layout.goal = 0;
        for (const Index cells : covered(layout))
            layout.goal += cells == 0 ? 0 : cells < least ? 2 : 1;
        found_.push_back(std::move(layout));
    }

    // Pieces on open pages, apart from each other.
    bool separate(CoarseLayout& layout, const std::vector<std::uint8_t>& is_open, bool anew,
                  const Progress& progress) {
        const PageGrid grid = grid_of(layout);
        std::vector<pack::ChartPoses> charts = poses_;
        pack::Spot spot;
        charts.push_back({grid.closed(is_open, spot)});
        pack::Separation separation(charts, ++seed_, progress);
        separation.confine(windows_of(problem_, grid, is_open, charts.back().front(), spot));
        pack::Layout spots = layout.spots;
        spots.push_back(spot);
        const pack::Frame frame{grid.sheet().right + 1, grid.sheet().top + 1};
        if (anew) {
            std::vector<std::size_t> order = pack::by_size(poses_);
            order.insert(order.begin(), poses_.size());
            spots = separation.insert_all(order, frame, coarse_moves);
            if (spots.empty())
                return false;
        }
        const bool done = separation.run(spots, frame, coarse_moves, work_);
        if (done) {
            spots.pop_back();
            layout.spots = std::move(spots);
        }
        return done;
    }

    bool begin(const Progress& progress) {
        double large = 0.0;
        double small = 0.0;
        for (std::size_t i = 0; i < poses_.size(); ++i)
            (problem_.is_large[i] != 0 ? large : small) += problem_.area[i];
        CoarseLayout layout;
        layout.columns = columns_;
        if (large > 0.0)
            layout.rows = static_cast<Index>(
                std::ceil(large / (tuning.covered * problem_.page_area() * columns_)));
        if (small > 0.0)
            layout.singles =
                static_cast<Index>(std::ceil(small / (tuning.covered * problem_.page_area())));
        for (int attempt = 0; attempt < tuning.attempts; ++attempt) {
            layout.spots.assign(poses_.size(), pack::Spot{});
            const std::vector<std::uint8_t> is_open(at(grid_of(layout).pages()), 1);
            if (separate(layout, is_open, true, progress)) {
                keep(std::move(layout));
                return true;
            }
            layout.rows += large > 0.0 ? 1 : 0;
            layout.singles += small > 0.0 ? 1 : 0;
        }
        return false;
    }

    // Closes one page of those in use, the emptiest that can be.
    bool close_some(const Progress& progress) {
        const std::vector<Index> cells = covered(found_.back());
        std::vector<std::size_t> pages;
        std::vector<std::uint8_t> is_open(cells.size(), 0);
        for (std::size_t page = 0; page < cells.size(); ++page)
            if (cells[page] > 0) {
                pages.push_back(page);
                is_open[page] = 1;
            }
        std::stable_sort(pages.begin(), pages.end(),
                         [&](std::size_t a, std::size_t b) { return cells[a] < cells[b]; });
        for (const std::size_t page : pages) {
            if (work_ <= 0)
                return false;
            CoarseLayout next = found_.back();
            is_open[page] = 0;
            if (separate(next, is_open, false, progress)) {
                keep(std::move(next));
                return true;
            }
            is_open[page] = 1;
        }
        return true; // again, with other numbers
    }

    const PageProblem& problem_;
    const std::vector<pack::ChartPoses>& poses_;
    Index columns_;
    std::uint64_t seed_;
    std::int64_t work_;
    std::vector<CoarseLayout> found_;
};

// The same layout in the problem's cells, where pieces turn and move a little.
std::optional<PageLayout> refined(const PageProblem& problem,
                                  const std::vector<pack::ChartPoses>& coarse,
                                  const CoarseLayout& found, const Progress& progress) {
    const PageGrid from(problem, found.columns, found.rows, found.singles, tuning.factor);
    const PageGrid grid(problem, found.columns, found.rows, found.singles, 1);
    std::vector<std::uint8_t> is_open(at(grid.pages()), 0);
    std::vector<pack::ChartPoses> charts;
    pack::Layout spots;
    std::vector<Index> cells(at(grid.pages()), 0);
    for (std::size_t i = 0; i < coarse.size(); ++i) {
        const pack::ChartCells& image = coarse[i][found.spots[i].pose];
        pack::Spot spot = found.spots[i];
        if (problem.is_large[i] != 0) {
            from.count(image, spot, cells);
            spot.x *= tuning.factor;
            spot.y *= tuning.factor;
        } else {
            const Index page = page_of(from, image, spot);
            cells[at(page)] += 1;
            spot.x = grid.clear(page).left + tuning.factor * (spot.x - from.clear(page).left);
            spot.y = grid.clear(page).bottom + tuning.factor * (spot.y - from.clear(page).bottom);
        }
        const double angle = std::atan2(image.sine, image.cosine);
        charts.emplace_back();
        for (int k = -fine_turns; k <= fine_turns; ++k)
            charts.back().push_back(k == 0 ? problem.poses[i][spot.pose].cells
                                           : pack::rasterize(problem.outlines[i],
                                                             angle + k * fine_turn, problem.cell,
                                                             0.5 * piece_gap));
        spot.pose = fine_turns;
        spots.push_back(spot);
    }
    for (std::size_t page = 0; page < cells.size(); ++page)
        is_open[page] = cells[page] > 0 ? 1 : 0;
    pack::Spot spot;
    charts.push_back({grid.closed(is_open, spot)});
    spots.push_back(spot);
    pack::Separation separation(charts, 1, progress);
    separation.confine(windows_of(problem, grid, is_open, charts.back().front(), spot));
    auto work = static_cast<std::int64_t>(tuning.fine_work);
    if (!separation.run(spots, {grid.sheet().right + 1, grid.sheet().top + 1}, fine_moves, work))
        return {};
    PageLayout result{found.columns, found.rows, found.singles, {}, {}, {}};
    for (std::size_t i = 0; i < coarse.size(); ++i) {
        result.images.push_back(charts[i][spots[i].pose]);
        result.spots.push_back(spots[i]);
        result.page.push_back(problem.is_large[i] != 0
                                  ? -1
                                  : page_of(grid, result.images.back(), spots[i]));
    }
    return result;
}

// Each piece at the lowest free place, the largest first.
PageLayout first_fit(const PageProblem& problem, Index columns, const Progress& progress) {
    constexpr std::size_t few_turns = 4;
    const std::size_t count = problem.poses.size();
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return problem.area[a] > problem.area[b];
    });
    PageLayout layout{columns, 0, 0, {}, {}, {}};
    layout.images.resize(count);
    layout.spots.resize(count);
    layout.page.assign(count, -1);
    Index longest = 1;
    for (const auto& poses : problem.poses)
        for (const pack::FitImage& image : poses)
            longest = std::max(longest, image.cells.width);
    const PageGrid one_row(problem, columns, 1, 0, 1);
    const Index width = one_row.sheet().right + 1;
    pack::FreeCells board(std::max(width, columns * problem.columns), longest);
    const auto put = [&](std::size_t i, pack::FreeCells& cells, const pack::FitWindow& window) {
        std::vector<pack::FitImage> few;
        std::vector<std::size_t> poses;
        const std::size_t every = std::max<std::size_t>(1, problem.poses[i].size() / few_turns);
        for (std::size_t k = 0; k < problem.poses[i].size(); k += every) {
            few.push_back(problem.poses[i][k]);
            poses.push_back(k);
        }
        if (!cells.put(few, window, layout.spots[i]))
            return false;
        layout.spots[i].pose = poses[layout.spots[i].pose];
        layout.images[i] = problem.poses[i][layout.spots[i].pose].cells;
        return true;
    };
    for (const std::size_t i : order)
        if (problem.is_large[i] != 0) {
            progress.check();
            put(i, board, {0, width});
        }
    std::vector<Index> cells;
    while (PageGrid(problem, columns, layout.rows, 0, 1).sheet().top + 1 < board.height())
        ++layout.rows;
    const PageGrid grid(problem, columns, layout.rows, static_cast<Index>(count), 1);
    cells.assign(at(grid.pages()), 0);
    for (std::size_t i = 0; i < count; ++i)
        if (problem.is_large[i] != 0)
            grid.count(layout.images[i], layout.spots[i], cells);
    std::vector<Index> pages;
    for (Index page = 0; page < grid.pages(); ++page)
        if (page >= grid.glued() || cells[at(page)] > 0)
            pages.push_back(page);
    for (const std::size_t i : order) {
        progress.check();
        for (const Index page : pages) {
            if (problem.is_large[i] != 0)
                break;
            const pack::Window w = grid.clear(page);
            if (!put(i, board, {w.left, w.right + 1, w.bottom, w.top + 1}))
                continue;
            layout.page[i] = page;
            break;
        }
    }
    layout.singles = static_cast<Index>(count);
    return layout;
}

// Columns of pages that the widest of the large pieces needs, and those of a square sheet.
std::array<Index, 2> columns_of(const PageProblem& problem) {
    double large = 0.0;
    Index widest = 0;
    for (std::size_t i = 0; i < problem.poses.size(); ++i) {
        if (problem.is_large[i] == 0)
            continue;
        large += problem.area[i];
        Index least = problem.poses[i].front().cells.width;
        for (const pack::FitImage& image : problem.poses[i])
            least = std::min(least, image.cells.width);
        widest = std::max(widest, least);
    }
    Index columns = 1;
    while (PageGrid(problem, columns, 1, 0, 1).sheet().right < widest)
        ++columns;
    const Vec2 step = problem.page.step();
    const double pages = large / (tuning.covered * problem.page_area());
    return {columns, static_cast<Index>(std::lround(std::sqrt(pages * step.y() / step.x())))};
}

} // namespace

PageLayout search_pages(const PageProblem& problem, Progress& progress) {
    const auto [least, even] = columns_of(problem);
    const std::size_t count = problem.poses.size();
    if (count > pack::very_many_charts)
        return first_fit(problem, std::max(least, even), progress);
    std::vector<pack::ChartPoses> coarse(count);
    parallel_for(
        static_cast<int>(count),
        [&](int i) {
            for (const pack::FitImage& image : problem.poses[at(i)])
                coarse[at(i)].push_back(pack::coarsen(image.cells, tuning.factor, getenv("SH") ? atof(getenv("SH")) : 0.5));
        },
        progress);
    std::vector<Search> searches;
    constexpr Index wider[] = {0, -1, 1, -2};
    for (int k = 0; k < tuning.searches; ++k)
        searches.emplace_back(problem, coarse, std::max(least, even + wider[k % 4]),
                              std::uint64_t{1000} * at(k), tuning.work / tuning.searches);
    auto searching = progress.part(0.9);
    parallel_for(
        tuning.searches, [&](int k) { searches[at(k)].run(searching); }, searching);
    std::vector<const CoarseLayout*> found;
    for (const Search& search : searches)
        for (const CoarseLayout& layout : search.found())
            found.push_back(&layout);
    std::stable_sort(found.begin(), found.end(), [](const CoarseLayout* a, const CoarseLayout* b) {
        return a->goal < b->goal;
    });
    if (getenv("PDBG")) for (const Search& q : searches) { fprintf(stderr, "search:"); for (auto& l : q.found()) fprintf(stderr, " %dx%d+%d:%d", l.columns, l.rows, l.singles, l.goal); fprintf(stderr, " work left %.2g\n", (double)q.left()); }
    for (const CoarseLayout* layout : found)
        if (auto result = refined(problem, coarse, *layout, progress)) { if (getenv("PDBG")) fprintf(stderr, "refined %d\n", layout->goal);
            return *result; } else if (getenv("PDBG")) fprintf(stderr, "refine failed %d\n", layout->goal);
    return first_fit(problem, std::max(least, even), progress);
}

} // namespace devseg::sheet
