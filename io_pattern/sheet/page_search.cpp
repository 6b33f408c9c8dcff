#include "sheet/page_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include "devseg/base/parallel.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    int searches = 4; // from different numbers
    int rounds = 10;  // after each, all end where one has found what cannot be better
    // Of all searches: cells that are compared and set, some seconds.
    std::int64_t work = 1'600'000'000;
    std::size_t tries = 4;      // turns of a piece on one page that are tried at a time
    double full = 0.9;          // share of the paper that no nesting covers
    double almost_empty = 0.05; // of a page: it is hardly worth the paper
    // A layout is better by the squares of the pages' shares as well: full pages, so that others
    // get empty. Worse ones are taken for a while: by so many pages at the start and in the end.
    double weight_of_fullness = 0.5;
    double first_step = 0.3;
    double last_step = 0.01;
};
constexpr Tuning tuning;

using Random = std::minstd_rand;

double share(Random& random) {
    return static_cast<double>(random() - Random::min()) /
           static_cast<double>(Random::max() - Random::min());
}

bool one_of(unsigned n, Random& random) {
    return random() % n == 0;
}

// What is best in the end; among equals the cost says which.
Index goal(const PageProblem& problem, const Filling& filling) {
    const PageCount count = count_pages(problem, filling);
    return count.pages + count.almost_empty;
}

// What the search makes less.
double cost(const PageProblem& problem, const Filling& filling) {
    const PageCount count = count_pages(problem, filling);
    double squares = 0.0;
    for (const PageSheet& sheet : filling.sheets)
        for (const Index cells : sheet.covered())
            squares += std::pow(cells / problem.page_cells(), 2);
    return count.pages + count.almost_empty - tuning.weight_of_fullness * squares;
}

class Search {
public:
    Search(const PageProblem& problem, unsigned seed)
        : problem_(problem), random_(seed), order_(problem.area.size()) {
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        const auto box = [&](std::size_t i) {
            const pack::ChartCells& cells = problem.poses[i].front().cells;
            return std::int64_t{cells.width} * cells.height;
        };
        std::stable_sort(order_.begin(), order_.end(),
                         [&](std::size_t a, std::size_t b) { return box(a) > box(b); });
    }

    // Goes on until so much of the work is done.
    void advance(double share_of_work, const Progress& progress) {
        const double all = static_cast<double>(tuning.work) / tuning.searches;
        if (kept_.sheet.empty()) {
            current_.sheet.assign(order_.size(), -1);
            current_.spot.resize(order_.size());
            put_all(order_, progress, current_);
            current_cost_ = cost(problem_, current_);
            keep(current_);
        }
        while (static_cast<double>(work_) < share_of_work * all && !is_best()) {
            Filling filling = laid_anew(current_, progress);
            const double now = cost(problem_, filling);
            const double step =
                tuning.first_step * std::pow(tuning.last_step / tuning.first_step,
                                             std::min(1.0, static_cast<double>(work_) / all));
            if (now > current_cost_ - step * std::log(std::max(1e-9, share(random_))))
                continue;
            if (std::pair(goal(problem_, filling), now) < kept_as_)
                keep(filling);
            current_ = std::move(filling);
            current_cost_ = now;
        }
    }

    // Whether nothing better is possible.
    bool is_best() const {
        const double total = std::accumulate(problem_.area.begin(), problem_.area.end(), 0.0);
        const PageCount count = count_pages(problem_, kept_);
        return count.pages <= std::ceil(total / (tuning.full * problem_.page_area())) &&
               count.almost_empty == 0;
    }

    const Filling& kept() const { return kept_; }
    const std::pair<Index, double>& kept_as() const { return kept_as_; }

private:
    void keep(const Filling& filling) {
        kept_ = filling;
        kept_as_ = {goal(problem_, filling), cost(problem_, filling)};
    }

    void put(std::size_t i, std::size_t chosen, const pack::Spot& spot, Filling& filling) {
        filling.sheets[chosen].take(problem_.poses[i][spot.pose], spot, problem_.area[i]);
        filling.sheet[i] = static_cast<Index>(chosen);
        filling.spot[i] = spot;
    }

    // On pages that are in use already, as far as possible; or on a sheet of its own.
    void put_large(std::size_t i, Filling& filling) {
        const std::vector<pack::FitImage>& poses = problem_.poses[i];
        const std::vector<Footprint>& footprints = problem_.footprints[i];
        const auto fewest = static_cast<Index>(footprints.front().pages.size());
        // As many new pages as on a sheet of its own may serve as well.
        Index limit = fewest + (one_of(2, random_) ? 1 : 0);
        std::optional<pack::Spot> best;
        std::size_t chosen = 0;
        for (std::size_t s = 0; s < filling.sheets.size(); ++s)
            if (const auto spot =
                    filling.sheets[s].place_large(poses, footprints, random_, limit)) {
                best = spot;
                chosen = s;
            }
        if (best)
            return put(i, chosen, *best, filling);
        const auto some =
            std::find_if(footprints.begin(), footprints.end(), [&](const Footprint& f) {
                return static_cast<Index>(f.pages.size()) > fewest;
            });
        const auto count =
            one_of(8, random_) ? footprints.end() - footprints.begin() : some - footprints.begin();
        const Footprint& f =
            footprints[static_cast<std::size_t>(random_() % static_cast<unsigned long>(count))];
        // Others may find room beside it, on any side.
        const auto more = static_cast<Index>(random_() % 4);
        const Index column = f.at_border[0] ? 0 : static_cast<Index>(random_() % (at(more) + 1));
        const Index row = f.at_border[1] ? 0 : static_cast<Index>(random_() % 2);
        filling.sheets.emplace_back(problem_, f.across + more, work_);
        put(i, filling.sheets.size() - 1,
            problem_.spot_of(f.places[random_() % f.places.size()], column, row), filling);
    }

    struct PageInUse {
        std::size_t sheet;
        Index page;
        Index covered;
    };

    // On the first page that has room: the fullest or emptiest first, or in any order.
    void put_small(std::size_t i, Filling& filling) {
        const std::vector<pack::FitImage>& poses = problem_.poses[i];
        std::vector<std::size_t> tried;
        for (std::size_t k = 0; k < std::min(poses.size(), tuning.tries); ++k)
            tried.push_back(random_() % poses.size());
        std::vector<PageInUse> pages;
        const double room = problem_.page_cells() - problem_.area[i] / std::pow(problem_.cell, 2);
        for (std::size_t s = 0; s < filling.sheets.size(); ++s)
            for (std::size_t p = 0; p < filling.sheets[s].covered().size(); ++p) {
                const Index covered = filling.sheets[s].covered()[p];
                if (covered > 0 && covered < room)
                    pages.push_back({s, static_cast<Index>(p), covered});
            }
        const auto way = random_() % 4;
        if (way < 3)
            std::stable_sort(pages.begin(), pages.end(), [&](const auto& a, const auto& b) {
                return way == 0 ? a.covered < b.covered : a.covered > b.covered;
            });
        for (const PageInUse& page : pages)
            if (const auto spot = filling.sheets[page.sheet].place_on_page(poses, tried, page.page))
                return put(i, page.sheet, *spot, filling);
        filling.sheets.emplace_back(problem_, 1, work_);
        const auto spot = filling.sheets.back().place_on_page(poses, tried, 0);
        put(i, filling.sheets.size() - 1, *spot, filling);
    }

    // Large pieces first, then what fits on the pages that these leave.
    void put_all(const std::vector<std::size_t>& order, const Progress& progress,
                 Filling& filling) {
        for (const bool large : {true, false})
            for (const std::size_t i : order) {
                progress.check();
                if ((problem_.is_large[i] != 0) != large)
                    continue;
                if (large)
                    put_large(i, filling);
                else
                    put_small(i, filling);
            }
    }

    Filling laid_anew(const Filling& filling, const Progress& progress) {
        const std::vector<std::uint8_t> moves = pieces_to_move(filling);
        Filling result = without(filling, moves);
        std::vector<std::size_t> moved;
        for (const std::size_t i : order_)
            if (moves[i] != 0)
                moved.push_back(i);
        for (std::size_t swaps = one_of(2, random_) ? moved.size() : 0; swaps > 0; --swaps)
            std::swap(moved[random_() % moved.size()], moved[random_() % moved.size()]);
        put_all(moved, progress, result);
        return result;
    }

    // Those on one page, mostly the emptiest one, or any; and some more.
    std::vector<std::uint8_t> pieces_to_move(const Filling& filling) {
        const std::size_t count = order_.size();
        std::vector<std::uint8_t> moves(count, 0);
        if (!one_of(4, random_)) {
            const PageInUse page = chosen_page(filling);
            for (std::size_t i = 0; i < count; ++i)
                if (at(filling.sheet[i]) == page.sheet)
                    moves[i] = filling.sheets[page.sheet].is_on(
                        problem_.poses[i][filling.spot[i].pose], filling.spot[i], page.page);
        } else if (one_of(2, random_)) { // all of a sheet
            const Index s = filling.sheet[random_() % count];
            for (std::size_t i = 0; i < count; ++i)
                moves[i] = filling.sheet[i] == s ? 1 : 0;
        }
        for (auto more = static_cast<int>(random_() % 3); more >= 0; --more)
            moves[random_() % count] = 1;
        if (one_of(2, random_)) // small ones are in the way of large ones, and easily laid again
            for (std::size_t i = 0; i < count; ++i)
                moves[i] = moves[i] != 0 || problem_.is_large[i] == 0 ? 1 : 0;
        return moves;
    }

    PageInUse chosen_page(const Filling& filling) {
        std::vector<PageInUse> pages;
        for (std::size_t s = 0; s < filling.sheets.size(); ++s)
            for (std::size_t p = 0; p < filling.sheets[s].covered().size(); ++p)
                if (const Index covered = filling.sheets[s].covered()[p]; covered > 0)
                    pages.push_back({s, static_cast<Index>(p), covered});
        std::stable_sort(pages.begin(), pages.end(),
                         [](const auto& a, const auto& b) { return a.covered < b.covered; });
        const double skewed = std::pow(share(random_), 3);
        return pages[std::min(pages.size() - 1, static_cast<std::size_t>(
                                                    skewed * static_cast<double>(pages.size())))];
    }

    // What stays where it is. Sheets that lose nothing are taken as they are.
    Filling without(const Filling& filling, const std::vector<std::uint8_t>& moves) {
        std::vector<std::uint8_t> loses(filling.sheets.size(), 0);
        std::vector<std::uint8_t> keeps(filling.sheets.size(), 0);
        for (std::size_t i = 0; i < moves.size(); ++i)
            (moves[i] != 0 ? loses : keeps)[at(filling.sheet[i])] = 1;
        Filling result;
        result.sheet.assign(moves.size(), -1);
        result.spot = filling.spot;
        std::vector<std::size_t> number(filling.sheets.size(), 0);
        for (std::size_t s = 0; s < filling.sheets.size(); ++s) {
            if (keeps[s] == 0)
                continue;
            number[s] = result.sheets.size();
            if (loses[s] != 0)
                result.sheets.emplace_back(problem_, filling.sheets[s].columns(), work_);
            else
                result.sheets.push_back(filling.sheets[s]);
        }
        for (std::size_t i = 0; i < moves.size(); ++i) {
            if (moves[i] != 0)
                continue;
            const std::size_t s = at(filling.sheet[i]);
            if (loses[s] != 0)
                put(i, number[s], filling.spot[i], result);
            else
                result.sheet[i] = static_cast<Index>(number[s]);
        }
        return result;
    }

    const PageProblem& problem_;
    Random random_;
    std::vector<std::size_t> order_; // the largest boxes first
    std::int64_t work_ = 0;
    Filling current_;
    Filling kept_;
    double current_cost_ = 0.0;
    std::pair<Index, double> kept_as_;
};

} // namespace

PageCount count_pages(const PageProblem& problem, const Filling& filling) {
    PageCount count;
    const double least = tuning.almost_empty * problem.page_cells();
    bool has_last = false;
    for (const PageSheet& sheet : filling.sheets) {
        count.pages += sheet.page_count();
        for (const Index cells : sheet.covered())
            if (cells > 0 && cells < least) {
                ++count.almost_empty;
                has_last |= sheet.page_count() == 1;
            }
    }
    count.almost_empty -= has_last ? 1 : 0;
    return count;
}

Filling search_pages(const PageProblem& problem, Progress& progress) {
    std::vector<Search> searches;
    for (int k = 0; k < tuning.searches; ++k)
        searches.emplace_back(problem, 1U + static_cast<unsigned>(k));
    for (int round = 1; round <= tuning.rounds; ++round) {
        auto part = progress.part(1.0 / tuning.rounds);
        parallel_for(
            tuning.searches,
            [&](int k) {
                searches[at(k)].advance(static_cast<double>(round) / tuning.rounds, part);
            },
            part);
        if (std::any_of(searches.begin(), searches.end(),
                        [](const Search& search) { return search.is_best(); }))
            break;
    }
    return std::min_element(
               searches.begin(), searches.end(),
               [](const Search& a, const Search& b) { return a.kept_as() < b.kept_as(); })
        ->kept();
}

} // namespace devseg::sheet
