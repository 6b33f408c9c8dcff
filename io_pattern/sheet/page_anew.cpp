#include "sheet/page_anew.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "devseg/base/parallel.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    int beginnings = 12;      // with an empty board and other dice,
    std::size_t best = 2;     // of which, and of what was found before, the best go on
    double beginning = 0.3;   // share of the work
    double word_work = 4.0;   // of cells, for a word of bits
    double board_work = 60.0; // of a cell, for each time that pages are closed
    double step_work = 1e4;   // of cells, for a move at least: no search goes on for ever
    double covered = 0.6;     // of pages, by pieces that are laid for the first time
    std::size_t images = 8;   // of a piece that are looked at when it is laid
    std::size_t most_out = 3; // pieces that are taken out at once
    std::size_t late = 20;    // moves ago: what is better than then is taken
    double full = 0.9;        // share of the paper that no nesting covers
    std::size_t alike = 5;    // layouts of the same goal that a search keeps
};
constexpr Tuning tuning;
constexpr pack::SeparationOptions coarse_moves{0, 8, 15};

class Search {
public:
    Search(const PageProblem& problem, const std::vector<BoardPiece>& pieces,
           const std::vector<pack::ChartPoses>& poses, const std::array<Index, 2>& size,
           std::uint64_t seed)
        : problem_(problem), pieces_(pieces), dice_(seed),
          board_(problem, pieces, size[0], size[1]), charts_(poses), waiting_(pieces.size()) {
        charts_.emplace_back();
        std::iota(waiting_.begin(), waiting_.end(), std::size_t{0});
        std::stable_sort(waiting_.begin(), waiting_.end(), [&](std::size_t a, std::size_t b) {
            return problem.area[a] < problem.area[b];
        });
    }

    // Begins with pieces that lie apart.
    void begin(const pack::Layout& spots) {
        for (std::size_t piece = 0; piece < pieces_.size(); ++piece)
            board_.lay(piece, spots[piece]);
        waiting_.clear();
        keep();
    }

    // Layouts that were found, none worse than those before.
    const std::vector<CoarseLayout>& found() const { return found_; }

    Index goal() const {
        return found_.empty() ? std::numeric_limits<Index>::max() : found_.back().goal;
    }

    // Goes on for so much work.
    void advance(double work, const Progress& progress) {
        work_ += work;
        while (work_ > 0.0 && !waiting_.empty()) { // the largest first
            progress.check();
            if (!lay(waiting_.back(), -1))
                return;
            waiting_.pop_back();
            if (waiting_.empty())
                keep();
        }
        while (work_ > 0.0 && waiting_.empty() && !is_best()) {
            progress.check();
            work_ -= tuning.step_work;
            if (dice_.coin())
                lay_anew();
            else
                close_one(progress);
        }
    }

private:
    bool is_best() const {
        const double total = std::accumulate(problem_.area.begin(), problem_.area.end(), 0.0);
        return goal() <=
               static_cast<Index>(std::ceil(total / (tuning.full * problem_.page_area())));
    }

    double cell() const { return problem_.factor * problem_.cell; }

    // Pages, and less for those that are nearly empty: they will be closed soon.
    double energy(const std::vector<Index>& covered) const {
        const double full = problem_.page_area() / (cell() * cell());
        double sum = 0.0;
        for (const Index cells : covered)
            if (cells > 0)
                sum += 1.0 + std::sqrt(std::min(1.0, cells / full));
        return sum;
    }

    void keep() {
        const std::vector<Index> covered = board_.covered();
        energy_ = energy(covered);
        const PageGrid& grid = board_.grid();
        const Index goal = goal_of(problem_, covered, cell());
        alike_ = goal < this->goal() ? 0 : alike_ + 1;
        if (goal < this->goal() || (goal == this->goal() && alike_ < tuning.alike))
            found_.push_back(
                {grid.columns(), grid.rows(), grid.pages() - grid.glued(), board_.spots(), goal});
    }

    bool lay(std::size_t piece, Index closed) {
        const std::size_t all = pieces_[piece].images.size();
        std::vector<std::size_t> images(std::min(all, tuning.images));
        std::iota(images.begin(), images.end(), std::size_t{0});
        if (all > images.size())
            for (std::size_t& image : images)
                image = dice_.below(all);
        double work = 0.0;
        const std::optional<pack::Spot> spot =
            board_.find_place(piece, images, closed, dice_, work);
        work_ += tuning.word_work * work;
        if (spot)
            board_.lay(piece, *spot);
        return spot.has_value();
    }

    // One of those that hardly anything covers, more likely.
    Index choose_page() {
        const std::vector<Index> covered = board_.covered();
        std::vector<Index> pages;
        for (std::size_t page = 0; page < covered.size(); ++page)
            if (covered[page] > 0)
                pages.push_back(static_cast<Index>(page));
        std::stable_sort(pages.begin(), pages.end(),
                         [&](Index p, Index q) { return covered[at(p)] < covered[at(q)]; });
        const std::size_t first = dice_.below(pages.size());
        return pages[std::min(first, dice_.below(pages.size()))];
    }

    void lay_anew() {
        const pack::Layout before = board_.spots();
        const Index closed = dice_.coin() ? choose_page() : -1;
        std::vector<std::size_t> out;
        if (closed >= 0)
            out = board_.pieces_on(closed);
        for (std::size_t k = 1 + dice_.below(tuning.most_out); k > (closed >= 0 ? 2 : 0); --k)
            out.push_back(dice_.below(pieces_.size()));
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        for (const std::size_t piece : out)
            board_.take_out(piece);
        if (dice_.coin())
            std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) {
                return problem_.area[a] > problem_.area[b];
            });
        else
            for (std::size_t i = out.size(); i > 1; --i)
                std::swap(out[i - 1], out[dice_.below(i)]);
        const bool done = std::all_of(out.begin(), out.end(),
                                      [&](std::size_t piece) { return lay(piece, closed); });
        if (!done || !is_taken(energy(board_.covered())))
            for (const std::size_t piece : out)
                board_.lay(piece, before[piece]);
        else
            keep();
    }

    // What is no worse than now, or than some moves ago [BB17].
    bool is_taken(double energy) {
        if (late_.empty())
            late_.assign(tuning.late, energy_);
        double& old = late_[moves_++ % late_.size()];
        const bool taken = energy <= std::max(energy_, old);
        old = taken ? energy : energy_;
        return taken;
    }

    void close_one(const Progress& progress) {
        const Index page = choose_page();
        std::vector<std::uint8_t> is_open;
        for (const Index cells : board_.covered())
            is_open.push_back(cells > 0 ? 1 : 0);
        is_open[at(page)] = 0;
        const PageGrid& grid = board_.grid();
        pack::Spot spot;
        charts_.back() = {grid.closed(is_open, spot)};
        const pack::ChartCells& closed = charts_.back().front();
        work_ -= tuning.board_work * closed.width * closed.height;
        pack::Separation separation(charts_, dice_.below(std::minstd_rand::max()), progress);
        separation.confine(grid.windows(is_open, closed, spot));
        pack::Layout spots = board_.spots();
        spots.push_back(spot);
        auto work = static_cast<std::int64_t>(std::max(1.0, work_));
        const auto before = static_cast<double>(work);
        const bool done = separation.run(spots, {grid.sheet().right + 1, grid.sheet().top + 1},
                                         coarse_moves, work);
        work_ -= before - static_cast<double>(work);
        if (!done)
            return;
        for (std::size_t piece = 0; piece < pieces_.size(); ++piece)
            board_.lay(piece, spots[piece]);
        keep();
    }

    const PageProblem& problem_;
    const std::vector<BoardPiece>& pieces_;
    Dice dice_;
    PageBoard board_;
    std::vector<pack::ChartPoses> charts_; // pieces, and what is closed
    std::vector<std::size_t> waiting_;     // pieces that were not laid yet
    double work_ = 0.0;
    double energy_ = 0.0; // as pieces lie now
    std::vector<double> late_;
    std::size_t moves_ = 0;
    std::size_t alike_ = 0;
    std::vector<CoarseLayout> found_;
};

// Columns and rows of a board on which all large pieces have room, two more than they need.
std::array<Index, 2> board_size(const PageProblem& problem,
                                const std::vector<pack::ChartPoses>& poses) {
    double area = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i)
        area += problem.is_large[i] != 0 ? problem.area[i] : 0.0;
    if (area == 0.0)
        return {1, 0};
    const auto [least, even] = columns_of(problem, tuning.covered);
    const Index columns = std::max(least, even);
    const double pages = area / (tuning.covered * problem.page_area());
    std::array<Index, 2> size{columns + 2, static_cast<Index>(std::ceil(pages / columns)) + 2};
    const auto has_room = [&](std::size_t i, const pack::Window& sheet) {
        return problem.is_large[i] == 0 ||
               std::any_of(poses[i].begin(), poses[i].end(), [&](const pack::ChartCells& image) {
                   return image.width <= sheet.right + 1 && image.height <= sheet.top + 1;
               });
    };
    for (std::size_t i = 0; i < poses.size(); ++i)
        while (!has_room(i, PageGrid(problem, size[0], size[1], 0, problem.factor).sheet()))
            ++size[1];
    return size;
}

} // namespace

std::vector<CoarseLayout> lay_pieces_anew(const PageProblem& problem,
                                          const std::vector<BoardPiece>& pieces,
                                          const std::vector<pack::ChartPoses>& poses,
                                          const CoarseLayout* start, double work,
                                          Progress& progress) {
    std::vector<Search> searches;
    if (start != nullptr) {
        searches.emplace_back(problem, pieces, poses,
                              std::array<Index, 2>{start->columns, start->rows}, 0);
        searches.front().begin(start->spots);
    }
    const std::size_t begun = searches.size();
    for (int k = 1; k <= tuning.beginnings; ++k)
        searches.emplace_back(problem, pieces, poses, board_size(problem, poses),
                              std::uint64_t{1000} * at(k));
    auto beginning = progress.part(tuning.beginning);
    parallel_for(
        tuning.beginnings,
        [&](int k) {
            searches[begun + at(k)].advance(tuning.beginning * work / tuning.beginnings, beginning);
        },
        beginning);
    std::vector<Search*> better;
    for (Search& search : searches)
        better.push_back(&search);
    std::stable_sort(better.begin(), better.end(),
                     [](const Search* a, const Search* b) { return a->goal() < b->goal(); });
    better.resize(std::min(better.size(), tuning.best));
    const double rest = (1.0 - tuning.beginning) * work;
    auto going_on = progress.part(progress.left());
    parallel_for(
        static_cast<int>(better.size()),
        [&](int k) { better[at(k)]->advance(rest / static_cast<double>(better.size()), going_on); },
        going_on);
    std::vector<CoarseLayout> found;
    for (const Search& search : searches)
        found.insert(found.end(), search.found().begin(), search.found().end());
    return found;
}

} // namespace devseg::sheet
