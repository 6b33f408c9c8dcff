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
    double coarse_cells = 26.0;       // where pieces look for pages
    int turns = 32;                   // of a piece, all around
    int all_turns = 180;              // of one that fits on a page in none of these
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
bool draw_poses(PageProblem& problem, std::size_t i) {
    const pack::Outline& outline = problem.outlines[i];
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
    for (const double angle : angles_of(outline, tuning.turns))
        poses.push_back(draw(angle));
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
    problem.columns = static_cast<Index>(std::floor(room.x() / problem.cell));
    problem.rows = static_cast<Index>(std::floor(room.y() / problem.cell));
    problem.factor = static_cast<Index>(std::lround(cells / tuning.coarse_cells));
    problem.poses.resize(pieces.size());
    problem.is_large.assign(pieces.size(), 0);
    for (const SheetPiece& piece : pieces) {
        problem.area.push_back(outline_area(piece));
        for (std::size_t k = 0; k < piece.cut.size(); ++k)
            problem.material += (k == 0 ? 1.0 : -1.0) * std::abs(plane::signed_area(piece.cut[k]));
        problem.outlines.push_back(pack::outline_of(piece.cut));
    }
    std::vector<std::uint8_t> is_fine(pieces.size(), 0);
    {
        auto drawing = progress.part(cells < tuning.most_cells ? 0.5 : 1.0);
        parallel_for(
            static_cast<int>(pieces.size()),
            [&](int i) { is_fine[at(i)] = draw_poses(problem, at(i)) ? 1 : 0; }, drawing);
    }
    if (cells < tuning.most_cells && std::count(is_fine.begin(), is_fine.end(), 0) > 0)
        return make_problem(pieces, page, 2.0 * cells, progress);
    return problem;
}

// Pages that large pieces have in common are one sheet, and every other page is one of its own.
struct Sheets {
    std::vector<Index> of_page; // on the board; -1: no piece lies there
    std::vector<double> area;   // of pieces
    std::vector<Index> pages;   // how many
};

// The pages that each piece is printed on, ascending.
std::vector<std::vector<Index>> find_pages(const PageLayout& layout, const PageGrid& grid) {
    std::vector<const pack::ChartCells*> images;
    for (const pack::ChartCells& image : layout.images)
        images.push_back(&image);
    const PageCover cover = grid.cover(images, layout.spots);
    std::vector<std::vector<Index>> pages;
    for (std::size_t i = 0; i < layout.spots.size(); ++i)
        pages.push_back(layout.page[i] >= 0
                            ? std::vector<Index>{layout.page[i]}
                            : grid.pages_of(layout.images[i], layout.spots[i], cover));
    return pages;
}

Sheets find_sheets(const PageProblem& problem, const std::vector<std::vector<Index>>& pages_of,
                   const PageGrid& grid) {
    std::vector<Index> parent(at(grid.pages()));
    std::iota(parent.begin(), parent.end(), Index{0});
    const auto root = [&](Index page) {
        while (parent[at(page)] != page)
            page = parent[at(page)];
        return page;
    };
    std::vector<std::uint8_t> is_used(parent.size(), 0);
    for (const std::vector<Index>& pages : pages_of)
        for (const Index page : pages) {
            is_used[at(page)] = 1;
            parent[at(root(page))] = root(pages.front());
        }
    Sheets sheets;
    sheets.of_page.assign(parent.size(), -1);
    for (Index page = 0; page < grid.pages(); ++page) {
        if (is_used[at(page)] == 0)
            continue;
        Index& sheet = sheets.of_page[at(root(page))];
        if (sheet < 0) {
            sheet = static_cast<Index>(sheets.area.size());
            sheets.area.push_back(0.0);
            sheets.pages.push_back(0);
        }
        sheets.of_page[at(page)] = sheet;
        ++sheets.pages[at(sheet)];
    }
    for (std::size_t i = 0; i < pages_of.size(); ++i)
        sheets.area[at(sheets.of_page[at(pages_of[i].front())])] += problem.area[i];
    return sheets;
}

// Sheets of several pages first, then single pages, the fullest first.
std::vector<Index> ranks_of(const Sheets& sheets) {
    std::vector<Index> order(sheets.area.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Index p, Index q) {
        const bool p_single = sheets.pages[at(p)] == 1;
        const bool q_single = sheets.pages[at(q)] == 1;
        return p_single != q_single ? q_single : sheets.area[at(p)] > sheets.area[at(q)];
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
    const PageLayout best = search_pages(problem, filling);
    const PageGrid grid(problem, best.columns, best.rows, best.singles, 1);
    const std::vector<std::vector<Index>> pages_of = find_pages(best, grid);
    const Sheets found = find_sheets(problem, pages_of, grid);
    const std::vector<Index> ranks = ranks_of(found);
    PageNesting result;
    std::vector<std::array<Index, 4>> extents( // columns and rows of the board
        ranks.size(), {grid.pages(), -1, grid.pages(), -1});
    for (Index p = 0; p < grid.pages(); ++p) {
        if (found.of_page[at(p)] < 0)
            continue;
        std::array<Index, 4>& e = extents[at(ranks[at(found.of_page[at(p)])])];
        const Index column = p < grid.glued() ? p % grid.columns() : 0;
        const Index row = p < grid.glued() ? p / grid.columns() : 0;
        e = {std::min(e[0], column), std::max(e[1], column), std::min(e[2], row),
             std::max(e[3], row)};
    }
    for (const std::array<Index, 4>& e : extents) {
        PatternSheet sheet{Vec2::Zero(), e[1] - e[0] + 1, e[3] - e[2] + 1};
        sheet.size = page.size + Vec2(sheet.columns - 1, sheet.rows - 1).cwiseProduct(page.step());
        result.sheets.push_back(sheet);
    }
    const double origin = page.margin + border_clearance - 0.5 * piece_gap;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        pack::Spot spot = best.spots[i];
        const Index on = pages_of[i].front();
        const Index sheet = ranks[at(found.of_page[at(on)])];
        Vec2 corner = Vec2(extents[at(sheet)][0], extents[at(sheet)][2]).cwiseProduct(page.step());
        if (on >= grid.glued()) {
            spot.x -= grid.clear(on).left;
            spot.y -= grid.clear(on).bottom;
        }
        result.placements.push_back(pack::placement_of(best.images[i], spot, problem.cell));
        result.placements.back().offset += Vec2::Constant(origin) - corner;
        result.sheet.push_back(sheet);
    }
    return result;
}

Eigen::AlignedBox2d part_box(const PatternSheet& sheet, const PageFormat& page, Index part_column,
                             Index part_row) {
    // What ends at the border of a strip does not go on behind it.
    constexpr double touch = 1e-6; // mm
    Eigen::AlignedBox2d box;
    for (const auto& [axis, part, pages] :
         {std::tuple(0, part_column, sheet.columns), std::tuple(1, part_row, sheet.rows)}) {
        const auto shown = pages_of_part(part);
        const double step = page.step()[axis];
        const double low = shown[1] * step;
        const double high = shown[0] * step + page.printable()[axis];
        const bool is_strip = part % 2 != 0;
        box.min()[axis] = page.margin + low + (is_strip || part == 0 ? 0.0 : tile_overlap + touch);
        box.max()[axis] = page.margin + high -
                          (is_strip || part + 1 == parts_of(pages) ? 0.0 : tile_overlap + touch);
    }
    return box;
}

} // namespace devseg::sheet
