#include "sheet/page_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/pack/nest.h"
#include "sheet/page_anew.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    int searches = 12;          // on sheets of other widths,
    int best = 2;               // of which the best go on, each with one half of
    double work = 8e9;          // cells that are looked at, some seconds
    double board_work = 60.0;   // of a cell, for each time that pages are closed
    double enough = 0.4;        // of a coarse cell: pieces have room on the finer ones
    double anew_enough = 0.5;   // the same for pieces that are laid anew, of which more layouts fit
    double anew_work = 1.6e10;  // cells
    double enough_paper = 0.55; // of pages, that pieces cover: then nothing is laid anew
    double covered = 0.6;       // of pages, by pieces that are laid for the first time
    int attempts = 8;           // on more and more pages
    Index longest = 3000;       // cells of a piece: of larger ones, others are few pages
    double full = 0.9;          // share of the paper that no nesting covers
};
constexpr Tuning tuning;
constexpr pack::SeparationOptions coarse_moves{0, 8, 15};

// Places of one large piece on its own, by the pages that it needs.
struct Footprints {
    std::vector<std::vector<pack::Spot>> spots; // as few as possible, and one more
    Index most_columns = 0;                     // of pages, as the piece may lie
    Index fewest = 0;
    Index most_rows = 0;
};

Footprints find_footprints(const PageProblem& problem, const pack::ChartPoses& poses,
                           const Progress& progress) {
    Footprints result;
    result.spots.resize(2);
    const Vec2 step = problem.page.step() / (problem.factor * problem.cell);
    Index across = 0;
    for (const pack::ChartCells& image : poses)
        across = std::max({across, image.width, image.height});
    result.most_columns = static_cast<Index>(std::ceil(across / step.x())) + 1;
    result.most_rows = static_cast<Index>(std::ceil(across / step.y())) + 1;
    const PageGrid grid(problem, result.most_columns, result.most_rows, 0, problem.factor);
    Index fewest = grid.glued();
    for (std::size_t pose = 0; pose < poses.size(); ++pose)
        for (Index y = 0; y < step.y(); ++y) {
            progress.check();
            for (Index x = 0; x < step.x(); ++x) {
                const Index pages = grid.least_pages(poses[pose], {pose, x, y});
                if (pages < fewest) {
                    result.spots[1] = pages + 1 == fewest ? std::move(result.spots[0])
                                                          : std::vector<pack::Spot>();
                    result.spots[0].clear();
                    fewest = pages;
                }
                if (pages <= fewest + 1)
                    result.spots[at(pages - fewest)].push_back({pose, x, y});
            }
        }
    result.fewest = fewest;
    if (result.spots[1].empty())
        result.spots.pop_back();
    return result;
}

class Search {
public:
    Search(const PageProblem& problem, const std::vector<pack::ChartPoses>& poses,
           const std::vector<Footprints>& footprints, Index columns, std::uint64_t seed)
        : problem_(problem), poses_(poses), footprints_(footprints), columns_(columns), seed_(seed),
          random_(static_cast<std::minstd_rand::result_type>(seed + 1)), charts_(poses) {
        charts_.emplace_back();
    }

    // All layouts that were found, each better than the one before.
    const std::vector<CoarseLayout>& found() const { return found_; }

    // Goes on for so much work.
    void advance(double work, const Progress& progress) {
        work_ += static_cast<std::int64_t>(work);
        while (work_ > 0 && found_.empty() && attempt_ < tuning.attempts)
            begin(progress);
        while (work_ > 0 && !found_.empty() && !is_best())
            close_some(progress);
    }

    Index goal() const {
        Index least = std::numeric_limits<Index>::max();
        for (const CoarseLayout& layout : found_)
            least = std::min(least, layout.goal);
        return least;
    }

private:
    bool is_best() const {
        const double total = std::accumulate(problem_.area.begin(), problem_.area.end(), 0.0);
        Index least = static_cast<Index>(std::ceil(total / (tuning.full * problem_.page_area())));
        for (const Footprints& f : footprints_)
            least = std::max(least, f.fewest);
        return goal() <= least;
    }

    PageGrid grid_of(const CoarseLayout& layout) const {
        return {problem_, layout.columns, layout.rows, layout.singles, problem_.factor};
    }

    // Cells on each page.
    std::vector<Index> covered(const CoarseLayout& layout) const {
        std::vector<const pack::ChartCells*> images;
        for (std::size_t i = 0; i < poses_.size(); ++i)
            images.push_back(&poses_[i][layout.spots[i].pose]);
        return grid_of(layout).cover(images, layout.spots).cells;
    }

    void keep(CoarseLayout layout) {
        layout.goal = goal_of(problem_, covered(layout), problem_.factor * problem_.cell);
        current_ = layout;
        if (found_.empty() || layout.goal < goal())
            found_.push_back(std::move(layout));
    }

    // Pieces on open pages, apart from each other.
    bool separate(CoarseLayout& layout, const std::vector<std::uint8_t>& is_open, bool anew,
                  const Progress& progress) {
        const PageGrid grid = grid_of(layout);
        pack::Spot spot;
        charts_.back() = {grid.closed(is_open, spot)};
        const pack::ChartCells& closed = charts_.back().front();
        work_ -= static_cast<std::int64_t>(tuning.board_work * closed.width * closed.height);
        pack::Separation separation(charts_, ++seed_, progress);
        separation.confine(grid.windows(is_open, closed, spot));
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

    // On a larger and larger part of the sheet, until pieces lie apart.
    void begin(const Progress& progress) {
        double large = 0.0;
        double small = 0.0;
        for (std::size_t i = 0; i < poses_.size(); ++i)
            (problem_.is_large[i] != 0 ? large : small) += problem_.area[i];
        const double covered = tuning.covered * problem_.page_area();
        CoarseLayout layout;
        Index rows = 0;
        layout.columns = columns_ + 1;
        if (large > 0.0)
            rows = static_cast<Index>(std::ceil(large / (covered * columns_))) + attempt_;
        if (small > 0.0)
            layout.singles = static_cast<Index>(std::ceil(small / covered)) + attempt_;
        ++attempt_;
        layout.rows = large > 0.0 ? rows + 1 : 0;
        for (const Footprints& f : footprints_) {
            layout.columns = std::max(layout.columns, f.most_columns);
            layout.rows = std::max(layout.rows, f.most_rows);
        }
        layout.spots.assign(poses_.size(), pack::Spot{});
        const PageGrid grid = grid_of(layout);
        std::vector<std::uint8_t> is_open(at(grid.pages()), 1);
        for (Index page = 0; page < grid.glued(); ++page)
            is_open[at(page)] =
                page % layout.columns < columns_ && page / layout.columns < rows ? 1 : 0;
        if (separate(layout, is_open, true, progress))
            keep(std::move(layout));
    }

    // A large piece jumps to where it needs few pages, or none does; and one page less is open.
    void close_some(const Progress& progress) {
        CoarseLayout next = current_;
        const auto count_open = [](const std::vector<Index>& cells) {
            return cells.size() -
                   static_cast<std::size_t>(std::count(cells.begin(), cells.end(), 0));
        };
        const std::size_t wanted = count_open(covered(next)) - 1;
        const std::size_t i = random_() % poses_.size();
        const bool jumps = problem_.is_large[i] != 0 && random_() % 2 == 0;
        if (jumps)
            jump(i, next);
        const std::vector<Index> cells = covered(next);
        std::vector<std::size_t> pages(cells.size());
        std::iota(pages.begin(), pages.end(), std::size_t{0});
        pages.erase(std::remove_if(pages.begin(), pages.end(),
                                   [&](std::size_t page) { return cells[page] == 0; }),
                    pages.end());
        std::stable_sort(pages.begin(), pages.end(),
                         [&](std::size_t a, std::size_t b) { return cells[a] < cells[b]; });
        std::vector<std::uint8_t> is_open(cells.size(), 0);
        for (const std::size_t page : pages)
            is_open[page] = 1;
        for (std::size_t open = pages.size(); open > wanted; --open) {
            // The emptiest, or mostly one of the emptiest.
            const std::size_t k =
                random_() % 2 == 0 ? 0
                                   : std::min(random_() % pages.size(), random_() % pages.size());
            is_open[pages[k]] = 0;
            pages.erase(pages.begin() + static_cast<std::ptrdiff_t>(k));
        }
        if (separate(next, is_open, false, progress))
            keep(std::move(next));
    }

    void jump(std::size_t i, CoarseLayout& layout) {
        const Footprints& f = footprints_[i];
        const std::vector<pack::Spot>& spots = f.spots[random_() % f.spots.size()];
        pack::Spot spot = spots[random_() % spots.size()];
        const PageGrid grid = grid_of(layout);
        const pack::Window all = grid.sheet();
        const pack::ChartCells& image = poses_[i][spot.pose];
        // As many pages further as there is room for.
        const Vec2 step = problem_.page.step() / (problem_.factor * problem_.cell);
        const auto shift = [&](Index low, Index high, double pages) {
            const auto most =
                static_cast<unsigned>(std::max(0.0, std::floor((high - low) / pages)));
            return static_cast<Index>(
                std::lround(pages * static_cast<double>(random_() % (most + 1))));
        };
        spot.x += shift(spot.x + image.width, all.right + 1, step.x());
        spot.y += shift(spot.y + image.height, all.top + 1, step.y());
        layout.spots[i] = spot;
    }

    const PageProblem& problem_;
    const std::vector<pack::ChartPoses>& poses_;
    const std::vector<Footprints>& footprints_;
    Index columns_;
    std::uint64_t seed_;
    std::minstd_rand random_;
    std::vector<pack::ChartPoses> charts_; // pieces, and what is closed
    int attempt_ = 0;
    std::int64_t work_ = 0;
    std::vector<CoarseLayout> found_;
    CoarseLayout current_; // with the fewest pages, almost empty ones or not
};

// All layouts that searches find which close pages.
std::vector<CoarseLayout> close_pages(const PageProblem& problem,
                                      const std::vector<pack::ChartPoses>& coarse,
                                      Progress& progress) {
    const auto [least, even] = columns_of(problem, tuning.covered);
    std::vector<Footprints> footprints(coarse.size());
    parallel_for(
        static_cast<int>(coarse.size()),
        [&](int i) {
            if (problem.is_large[at(i)] != 0)
                footprints[at(i)] = find_footprints(problem, coarse[at(i)], progress);
        },
        progress);
    std::vector<Search> searches;
    for (int k = 0; k < tuning.searches; ++k) {
        const Index wider = (k % 2 == 0 ? 1 : -1) * ((k + 1) / 2);
        searches.emplace_back(problem, coarse, footprints, std::max(least, even + wider),
                              std::uint64_t{1000} * at(k));
    }
    const double work = tuning.work / (2 * tuning.searches);
    auto searching = progress.part(0.3);
    parallel_for(
        tuning.searches, [&](int k) { searches[at(k)].advance(work, searching); }, searching);
    // The better ones go on.
    std::vector<Search*> better;
    for (Search& search : searches)
        better.push_back(&search);
    std::stable_sort(better.begin(), better.end(),
                     [](const Search* a, const Search* b) { return a->goal() < b->goal(); });
    auto going_on = progress.part(0.3);
    parallel_for(
        tuning.best,
        [&](int k) { better[at(k)]->advance(0.5 * tuning.work / tuning.best, going_on); },
        going_on);
    std::vector<CoarseLayout> found;
    for (const Search& search : searches)
        found.insert(found.end(), search.found().begin(), search.found().end());
    return found;
}

std::vector<BoardPiece> board_pieces(const PageProblem& problem, Progress& progress) {
    std::vector<BoardPiece> pieces(problem.poses.size());
    parallel_for(
        static_cast<int>(pieces.size()),
        [&](int i) { pieces[at(i)] = board_piece(problem, at(i), tuning.anew_enough); }, progress);
    return pieces;
}

std::vector<pack::ChartPoses> poses_of(const std::vector<BoardPiece>& pieces) {
    std::vector<pack::ChartPoses> poses(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i)
        for (const pack::FitImage& image : pieces[i].images)
            poses[i].push_back(image.cells);
    return poses;
}

// Whether pieces cover enough of the pages, and none is almost empty.
bool is_good(const PageProblem& problem, const std::vector<pack::ChartPoses>& poses,
             const CoarseLayout& layout) {
    std::vector<const pack::ChartCells*> images;
    for (std::size_t i = 0; i < poses.size(); ++i)
        images.push_back(&poses[i][layout.spots[i].pose]);
    const std::vector<Index> cells =
        PageGrid(problem, layout.columns, layout.rows, layout.singles, problem.factor)
            .cover(images, layout.spots)
            .cells;
    const auto pages = static_cast<Index>(cells.size()) -
                       static_cast<Index>(std::count(cells.begin(), cells.end(), Index{0}));
    return layout.goal == pages &&
           pages <= std::ceil(problem.material / (tuning.enough_paper * problem.page_area()));
}

struct Candidate {
    const CoarseLayout* layout;
    const std::vector<pack::ChartPoses>* poses; // that it is of
};

} // namespace

PageLayout search_pages(const PageProblem& problem, Progress& progress) {
    const auto [least, even] = columns_of(problem, tuning.covered);
    const std::size_t count = problem.poses.size();
    PageLayout best = first_fit(problem, std::max(least, even), progress);
    Index longest = 0;
    for (const auto& poses : problem.poses)
        for (const pack::FitImage& image : poses)
            longest = std::max({longest, image.cells.width, image.cells.height});
    if (count > pack::very_many_charts || longest > tuning.longest)
        return best;
    std::vector<pack::ChartPoses> coarse(count);
    parallel_for(
        static_cast<int>(count),
        [&](int i) {
            for (const pack::FitImage& image : problem.poses[at(i)])
                coarse[at(i)].push_back(pack::coarsen(image.cells, problem.factor, tuning.enough));
        },
        progress);
    const std::vector<CoarseLayout> closing = close_pages(problem, coarse, progress);
    std::vector<Candidate> found;
    for (const CoarseLayout& layout : closing)
        found.push_back({&layout, &coarse});
    const auto fewer = [](const Candidate& a, const Candidate& b) {
        return a.layout->goal < b.layout->goal;
    };
    const auto start = std::min_element(found.begin(), found.end(), fewer);
    std::vector<pack::ChartPoses> poses;
    std::vector<CoarseLayout> anew;
    if (start == found.end() || !is_good(problem, coarse, *start->layout)) {
        auto laying = progress.part(progress.left());
        const std::vector<BoardPiece> pieces = board_pieces(problem, laying);
        poses = poses_of(pieces);
        anew =
            lay_pieces_anew(problem, pieces, poses, start != found.end() ? start->layout : nullptr,
                            tuning.anew_work, laying);
    }
    for (const CoarseLayout& layout : anew)
        found.push_back({&layout, &poses});
    std::stable_sort(found.begin(), found.end(), fewer);
    const Index first = goal_of(problem, best);
    for (const Candidate& candidate : found) {
        if (candidate.layout->goal >= first)
            break;
        if (auto result = refined(problem, *candidate.poses, *candidate.layout, progress))
            return *result;
    }
    return best;
}

} // namespace devseg::sheet
