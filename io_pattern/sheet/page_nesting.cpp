#include "sheet/page_nesting.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/plane/plane.h"
#include "sheet/page_sheet.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    double cells = 200.0;             // along the shorter side of a page: about 1 mm of an A4 page
    int turns = 16;                   // of a piece on one page, all around
    int large_turns = 36;             // of a piece on several pages, of which
    std::size_t tries = 4;            // so many are tried at a time
    double most_pages_across = 200.0; // of one piece: more is a wrong scale
    // Rows of images that are compared with rows of sheets: about two seconds, and where one
    // attempt takes longer than that, one attempt.
    std::int64_t work = 1'200'000'000;
    int attempts = 800;    // at most
    unsigned restart = 12; // one of so many attempts lays all pieces anew
    double full = 0.9;     // share of the paper that no nesting covers
    // Share of a page below which it is hardly worth the paper.
    double almost_empty = 0.05;
};
constexpr Tuning tuning;

double outline_area(const SheetPiece& piece) {
    return std::abs(plane::signed_area(piece.cut.front()));
}

Vec2 turned_size(const std::vector<Vec2>& points, double angle) {
    return plane::box_of(points, [&](const Vec2& p) { return Eigen::Rotation2Dd(angle) * p; })
        .sizes();
}

// Angles at which the piece is tried, around that of its least box.
std::vector<double> angles_of(const pack::Outline& outline, int turns) {
    const double base = pack::best_box_angle(outline);
    std::vector<double> angles;
    for (int i = 0; i < turns; ++i)
        angles.push_back(base + 2.0 * pi * i / turns);
    return angles;
}

// The images of a piece on one page; of one that fits on none, all images.
void draw_poses(const SheetPiece& piece, PageProblem& problem, std::size_t i) {
    const pack::Outline outline = pack::outline_of(piece.cut);
    const Vec2 room = problem.page.printable() + Vec2::Constant(problem.cell);
    for (const bool large : {false, true}) {
        for (const double angle : angles_of(outline, large ? tuning.large_turns : tuning.turns)) {
            const bool fits = (room - turned_size(outline.hull, angle)).minCoeff() >= 0.0;
            if (!large && !fits)
                continue;
            pack::FitImage image(pack::rasterize(outline, angle, problem.cell, 0.5 * piece_gap));
            if (large ||
                (image.cells.width <= problem.columns && image.cells.height <= problem.rows))
                problem.poses[i].push_back(std::move(image));
        }
        if (!problem.poses[i].empty()) {
            problem.is_large[i] = large ? 1 : 0;
            if (large)
                problem.footprints[i] = find_footprints(problem, problem.poses[i]);
            return;
        }
    }
}

[[noreturn]] void refuse_size(const SheetPiece& piece, const PageFormat& page) {
    const Vec2 size = piece.box().sizes();
    throw InvalidParameter(
        "page: expected pieces that fit on " + writers::number_text(page.printable().x(), 1) +
        " x " + writers::number_text(page.printable().y(), 1) + " mm, found " + piece.name +
        " of " + writers::number_text(size.x(), 1) + " x " + writers::number_text(size.y(), 1) +
        " mm; take a larger page, switch tiling on, or split large pieces with "
        "max_piece_mm");
}

void check_scale(const std::vector<SheetPiece>& pieces, const PageFormat& page) {
    double widest = 0.0;
    for (const SheetPiece& piece : pieces)
        widest = std::max(widest, piece.box().sizes().norm() + piece_gap);
    if (widest > tuning.most_pages_across * page.step().minCoeff())
        throw InvalidParameter("mm_per_unit: expected pieces of at most " +
                               writers::number_text(tuning.most_pages_across, 0) +
                               " pages, found one of " + writers::number_text(widest / 1000.0, 1) +
                               " m; give a smaller mm_per_unit or height_mm, or a larger page");
}

PageProblem make_problem(const std::vector<SheetPiece>& pieces, const PageFormat& page,
                         Progress& progress) {
    PageProblem problem;
    problem.page = page;
    problem.cell = page.printable().minCoeff() / tuning.cells;
    const Vec2 room = page.printable() + Vec2::Constant(piece_gap - 2.0 * border_clearance);
    problem.columns = problem.cells_down(room.x());
    problem.rows = problem.cells_down(room.y());
    problem.poses.resize(pieces.size());
    problem.footprints.resize(pieces.size());
    problem.is_large.assign(pieces.size(), 0);
    for (const SheetPiece& piece : pieces)
        problem.area.push_back(outline_area(piece));
    parallel_for(
        static_cast<int>(pieces.size()), [&](int i) { draw_poses(pieces[at(i)], problem, at(i)); },
        progress);
    for (const auto& poses : problem.poses)
        for (const pack::FitImage& image : poses)
            for (const pack::CellRun& run : image.runs)
                problem.longest_run = std::max(problem.longest_run, run.last - run.first);
    return problem;
}

// Where each piece lies.
struct Filling {
    std::vector<PageSheet> sheets;
    std::vector<Index> sheet; // of each piece
    std::vector<pack::Spot> spot;

    Index page_count() const {
        Index count = 0;
        for (const PageSheet& s : sheets)
            count += s.page_count();
        return count;
    }
    // The sheet with the page that has the least on it.
    Index emptiest() const {
        const auto least = std::min_element(sheets.begin(), sheets.end(),
                                            [](const PageSheet& a, const PageSheet& b) {
                                                return a.fewest_cells() < b.fewest_cells();
                                            });
        return static_cast<Index>(least - sheets.begin());
    }
    // Fewer pages, and less on the emptiest one: so that it may vanish.
    std::pair<Index, Index> score() const {
        return {page_count(), sheets[at(emptiest())].fewest_cells()};
    }
    // Fewer pages, and fewer that are almost empty: what is kept in the end.
    std::pair<Index, Index> cost(const PageProblem& problem) const {
        const auto least = static_cast<Index>(tuning.almost_empty * problem.page_area() /
                                              (problem.cell * problem.cell));
        Index poor = 0;
        for (const PageSheet& s : sheets)
            poor += s.pages_below(least);
        return {page_count(), poor};
    }
    void put(const PageProblem& problem, std::size_t i, std::size_t chosen,
             const pack::Spot& place) {
        sheets[chosen].take(problem.poses[i][place.pose], place, problem.area[i]);
        sheet[i] = static_cast<Index>(chosen);
        spot[i] = place;
    }
};

// Some of the poses, evenly all around or any.
std::vector<std::size_t> chosen_poses(std::size_t count, std::size_t most,
                                      std::minstd_rand* random) {
    std::vector<std::size_t> some;
    const std::size_t tries = std::min(count, most);
    for (std::size_t k = 0; k < tries; ++k)
        some.push_back(random == nullptr ? k * count / tries : (*random)() % count);
    return some;
}

// `random`: what else is as good, and where it lies; none: what looks best at first.
void put_large(const PageProblem& problem, std::size_t i, std::minstd_rand* random,
               std::int64_t& work, Filling& filling) {
    const std::vector<pack::FitImage>& poses = problem.poses[i];
    const std::vector<std::size_t> tried = chosen_poses(poses.size(), tuning.tries, random);
    PageSheet::LargePlace best;
    std::size_t chosen = filling.sheets.size();
    for (std::size_t s = 0; s < filling.sheets.size(); ++s) {
        const PageSheet::LargePlace place =
            filling.sheets[s].place_of(poses, tried, problem.footprints[i], random);
        if (place.is_better_than(best)) {
            best = place;
            chosen = s;
        }
    }
    Index most = 1;
    for (const std::size_t pose : tried)
        most = std::max(most, PageSheet::pages_for(poses[pose].cells.width, problem.columns,
                                                   problem.page.step().x() / problem.cell));
    for (const Footprint& f : problem.footprints[i])
        most = std::max(most, f.across);
    // Others may find room beside it on a wider sheet.
    most += random != nullptr && (*random)() % 2 == 0 ? 1 : 0;
    std::optional<PageSheet> added;
    for (Index columns = 1; columns <= most; ++columns) {
        PageSheet fresh(problem, columns, work);
        const PageSheet::LargePlace place =
            fresh.place_of(poses, tried, problem.footprints[i], random);
        const bool instead = random != nullptr && (*random)() % 2 == 0;
        if (place.found && (!best.found || place.new_pages < best.new_pages ||
                            (instead && place.new_pages == best.new_pages))) {
            best = place;
            added = std::move(fresh);
        }
    }
    if (added) {
        chosen = filling.sheets.size();
        filling.sheets.push_back(std::move(*added));
    }
    filling.put(problem, i, chosen, best.spot);
}

void put_small(const PageProblem& problem, std::size_t i, std::minstd_rand* random,
               std::int64_t& work, Filling& filling) {
    const std::vector<pack::FitImage>& poses = problem.poses[i];
    const std::vector<std::size_t> tried =
        chosen_poses(poses.size(), random != nullptr ? tuning.tries : poses.size(), random);
    pack::Spot spot;
    for (std::size_t s = 0; s < filling.sheets.size(); ++s)
        if (filling.sheets[s].put_on_page(poses, tried, spot)) {
            filling.put(problem, i, s, spot);
            return;
        }
    filling.sheets.emplace_back(problem, 1, work);
    const PageSheet::LargePlace place = filling.sheets.back().place_of(poses, tried, {}, nullptr);
    filling.put(problem, i, filling.sheets.size() - 1, place.spot);
}

// Large pieces first, then what fits on the pages that these leave.
void put_all(const PageProblem& problem, const std::vector<std::size_t>& order,
             std::minstd_rand* random, std::int64_t& work, const Progress& progress,
             Filling& filling) {
    for (const bool large : {true, false})
        for (const std::size_t i : order) {
            progress.check();
            if ((problem.is_large[i] != 0) != large)
                continue;
            if (large)
                put_large(problem, i, random, work, filling);
            else
                put_small(problem, i, random, work, filling);
        }
}

// Which pieces are laid anew: those of the emptiest page, or any, and some more.
std::vector<std::uint8_t> pieces_to_move(const PageProblem& problem, const Filling& filling,
                                         std::minstd_rand& random) {
    const std::size_t count = problem.area.size();
    std::vector<std::uint8_t> moves(count, 0);
    if (random() % tuning.restart == 0)
        return std::vector<std::uint8_t>(count, 1);
    const Index emptiest = filling.emptiest();
    const PageSheet& sheet = filling.sheets[at(emptiest)];
    if (random() % 4 != 0)
        for (std::size_t i = 0; i < count; ++i)
            if (filling.sheet[i] == emptiest)
                moves[i] =
                    sheet.needs_emptiest(problem.poses[i][filling.spot[i].pose], filling.spot[i])
                        ? 1
                        : 0;
    for (auto more = static_cast<int>(random() % 3); more >= 0; --more)
        moves[random() % count] = 1;
    if (random() % 2 == 0) // small ones are in the way of large ones, and easily laid again
        for (std::size_t i = 0; i < count; ++i)
            moves[i] = moves[i] != 0 || problem.is_large[i] == 0 ? 1 : 0;
    return moves;
}

// What stays where it is.
Filling without(const PageProblem& problem, const Filling& filling,
                const std::vector<std::uint8_t>& moves, std::int64_t& work) {
    const std::size_t count = moves.size();
    Filling result;
    result.sheet.assign(count, -1);
    result.spot = filling.spot;
    std::vector<Index> number(filling.sheets.size(), -1);
    for (std::size_t i = 0; i < count; ++i) {
        if (moves[i] != 0)
            continue;
        Index& chosen = number[at(filling.sheet[i])];
        if (chosen < 0) {
            chosen = static_cast<Index>(result.sheets.size());
            result.sheets.emplace_back(problem, filling.sheets[at(filling.sheet[i])].columns(),
                                       work);
        }
        result.put(problem, i, at(chosen), filling.spot[i]);
    }
    return result;
}

// The largest boxes first.
std::vector<std::size_t> first_order(const PageProblem& problem) {
    std::vector<std::size_t> order(problem.area.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto box = [&](std::size_t i) {
        const pack::ChartCells& cells = problem.poses[i].front().cells;
        return std::int64_t{cells.width} * cells.height;
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return box(a) > box(b); });
    return order;
}

// Some pieces are taken out and laid anew, again and again.
Filling best_filling(const PageProblem& problem, Progress& progress) {
    const std::vector<std::size_t> order = first_order(problem);
    const double total = std::accumulate(problem.area.begin(), problem.area.end(), 0.0);
    const auto least = static_cast<Index>(std::ceil(total / (tuning.full * problem.page_area())));
    std::int64_t work = 0;
    Filling current;
    current.sheet.assign(order.size(), -1);
    current.spot.resize(order.size());
    put_all(problem, order, nullptr, work, progress, current);
    Filling kept = current;
    std::minstd_rand random; // the same numbers in every run
    for (int k = 0; k < tuning.attempts && work < tuning.work &&
                    kept.cost(problem) > std::pair(least, Index{0});
         ++k) {
        progress.update(static_cast<double>(work) / static_cast<double>(tuning.work));
        const std::vector<std::uint8_t> moves = pieces_to_move(problem, current, random);
        Filling filling = without(problem, current, moves, work);
        std::vector<std::size_t> moved;
        for (const std::size_t i : order)
            if (moves[i] != 0)
                moved.push_back(i);
        for (std::size_t swaps = random() % 2 == 0 ? moved.size() : 0; swaps > 0; --swaps)
            std::swap(moved[random() % moved.size()], moved[random() % moved.size()]);
        put_all(problem, moved, &random, work, progress, filling);
        if (filling.cost(problem) < kept.cost(problem))
            kept = filling;
        if (filling.score() <= current.score())
            current = std::move(filling);
    }
    return kept;
}

// Sheets of several pages first, then single pages, the fullest first.
std::vector<Index> ranks_of(const Filling& filling) {
    std::vector<Index> order(filling.sheets.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
        const PageSheet& p = filling.sheets[at(a)];
        const PageSheet& q = filling.sheets[at(b)];
        const bool p_single = p.page_count() == 1;
        const bool q_single = q.page_count() == 1;
        return p_single != q_single ? q_single : p.area() > q.area();
    });
    std::vector<Index> ranks(order.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        ranks[at(order[i])] = static_cast<Index>(i);
    return ranks;
}

} // namespace

PageNesting nest_on_pages(const std::vector<SheetPiece>& pieces, const PageFormat& page,
                          bool tiling, Progress& progress) {
    check_scale(pieces, page);
    auto drawing = progress.part(0.1);
    const PageProblem problem = make_problem(pieces, page, drawing);
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (problem.is_large[i] != 0 && !tiling)
            refuse_size(pieces[i], page);
    auto filling = progress.part(progress.left());
    const Filling best = best_filling(problem, filling);
    const std::vector<Index> ranks = ranks_of(best);
    PageNesting result;
    result.sheets.resize(best.sheets.size());
    for (std::size_t s = 0; s < ranks.size(); ++s)
        result.sheets[at(ranks[s])] = best.sheets[s].result();
    const double origin = page.margin + border_clearance - 0.5 * piece_gap;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const pack::Spot& spot = best.spot[i];
        result.placements.push_back(
            pack::placement_of(problem.poses[i][spot.pose].cells, spot, problem.cell));
        result.placements.back().offset += Vec2::Constant(origin);
        result.sheet.push_back(ranks[at(best.sheet[i])]);
    }
    return result;
}

Eigen::AlignedBox2d own_part(const PageFormat& page, Index column, Index row_from_below) {
    // What ends at the border of a strip does not go on behind it.
    constexpr double touch = 1e-6; // mm
    const Vec2 place(column, row_from_below);
    const Vec2 low = Vec2::Constant(page.margin) + place.cwiseProduct(page.step());
    const Vec2 strips((place.array() > 0.0).cast<double>() * (tile_overlap + touch));
    return {low + strips, low + page.printable()};
}

} // namespace devseg::sheet
