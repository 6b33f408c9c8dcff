#include "sheet/page_nesting.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/plane/plane.h"
#include "sheet/page_search.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    // Along the shorter side of a page: 1.5 mm of an A4 page, and more where a piece fits narrowly.
    double cells = 130.0;
    double most_cells = 1000.0;
    int turns = 16;                   // of a piece on one page, all around
    int all_turns = 180;              // of one that fits in none of these
    int large_turns = 36;             // of a piece on several pages
    double most_pages_across = 200.0; // of one piece: more is a wrong scale
};
constexpr Tuning tuning;

double outline_area(const SheetPiece& piece) {
    return std::abs(plane::signed_area(piece.cut.front()));
}

Vec2 turned_size(const std::vector<Vec2>& points, double angle) {
    return plane::box_of(points, [&](const Vec2& p) { return Eigen::Rotation2Dd(angle) * p; })
        .sizes();
}

// Turns of the piece, evenly all around from that of its least box.
std::vector<double> angles_of(const pack::Outline& outline, int turns) {
    const double base = pack::best_box_angle(outline);
    std::vector<double> angles;
    for (int i = 0; i < turns; ++i)
        angles.push_back(base + 2.0 * pi * i / turns);
    return angles;
}

// How much of a page is left beside the piece, in the direction that has less; below 0: it does not
// fit.
double room_beside(const pack::Outline& outline, const PageFormat& page, double angle) {
    const Vec2 room = page.printable() - Vec2::Constant(2.0 * border_clearance);
    return (room - turned_size(outline.hull, angle)).minCoeff();
}

// Those turns of the piece that fit on a page; where none of the usual ones does, the best of all.
std::vector<double> fitting_angles(const pack::Outline& outline, const PageFormat& page) {
    std::vector<double> angles = angles_of(outline, tuning.turns);
    const auto fits = [&](double angle) { return room_beside(outline, page, angle) >= 0.0; };
    angles.erase(std::remove_if(angles.begin(), angles.end(), std::not_fn(fits)), angles.end());
    if (!angles.empty())
        return angles;
    double best = 0.0;
    for (const double angle : angles_of(outline, tuning.all_turns))
        if (angles.empty() || room_beside(outline, page, angle) > best) {
            angles = {angle};
            best = room_beside(outline, page, angle);
        }
    return best >= 0.0 ? angles : std::vector<double>();
}

// The images of a piece: on one page, or on several where it fits on none. False where the grid is
// too coarse for a piece that fits: images are larger than their pieces.
bool draw_poses(const SheetPiece& piece, PageProblem& problem, std::size_t i) {
    const pack::Outline outline = pack::outline_of(piece.cut);
    const std::vector<double> fitting = fitting_angles(outline, problem.page);
    std::vector<pack::FitImage>& poses = problem.poses[i];
    const auto draw = [&](double angle) {
        return pack::FitImage(pack::rasterize(outline, angle, problem.cell, 0.5 * piece_gap));
    };
    for (const double angle : fitting) {
        pack::FitImage image = draw(angle);
        if (image.cells.width <= problem.columns && image.cells.height <= problem.rows)
            poses.push_back(std::move(image));
    }
    problem.is_large[i] = poses.empty() ? 1 : 0;
    if (!poses.empty())
        return true;
    for (const double angle : angles_of(outline, tuning.large_turns))
        poses.push_back(draw(angle));
    problem.footprints[i] = find_footprints(problem, poses);
    return fitting.empty();
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
                         double cells, Progress& progress) {
    PageProblem problem;
    problem.page = page;
    problem.cell = page.printable().minCoeff() / cells;
    const Vec2 room = page.printable() + Vec2::Constant(piece_gap - 2.0 * border_clearance);
    problem.columns = problem.cells_down(room.x());
    problem.rows = problem.cells_down(room.y());
    problem.poses.resize(pieces.size());
    problem.footprints.resize(pieces.size());
    problem.is_large.assign(pieces.size(), 0);
    for (const SheetPiece& piece : pieces)
        problem.area.push_back(outline_area(piece));
    std::vector<std::uint8_t> is_fine(pieces.size(), 0);
    {
        auto drawing = progress.part(cells < tuning.most_cells ? 0.5 : 1.0);
        parallel_for(
            static_cast<int>(pieces.size()),
            [&](int i) { is_fine[at(i)] = draw_poses(pieces[at(i)], problem, at(i)) ? 1 : 0; },
            drawing);
    }
    if (cells < tuning.most_cells && std::count(is_fine.begin(), is_fine.end(), 0) > 0)
        return make_problem(pieces, page, 2.0 * cells, progress);
    for (const auto& poses : problem.poses)
        for (const pack::FitImage& image : poses)
            for (const pack::CellRun& run : image.runs)
                problem.longest_run = std::max(problem.longest_run, run.last - run.first);
    return problem;
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
    const PageProblem problem = make_problem(pieces, page, tuning.cells, drawing);
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (problem.is_large[i] != 0 && !tiling)
            refuse_size(pieces[i], page);
    auto filling = progress.part(progress.left());
    const Filling best = search_pages(problem, filling);
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
        const PageSpot margin = best.sheets[at(best.sheet[i])].empty_margin();
        result.placements.back().offset +=
            Vec2::Constant(origin) - Vec2(margin[0], margin[1]).cwiseProduct(page.step());
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
