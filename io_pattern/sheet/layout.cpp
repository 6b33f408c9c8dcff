#include "sheet/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/pack/first_fit.h"
#include "devseg/plane/box_grid.h"
#include "devseg/plane/plane.h"
#include "sheet/marker.h"
#include "sheet/page_nesting.h"
#include "sheet/segment_grid.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

// Of paper, at its widest place: fingers and tweezers hold no less.
constexpr double least_glued_width = 3.0; // mm
constexpr std::size_t most_names = 5;     // of a note

// Turns that are tried for the least box around a piece, within a quarter. The exact box, which
// lies on an edge of the outline, took more pages.
constexpr int box_turns = 30;

Vec2 turned_size(const std::vector<Vec2>& points, double angle) {
    return plane::box_of(points, [&](const Vec2& p) { return Eigen::Rotation2Dd(angle) * p; })
        .sizes();
}

double least_box_angle(const std::vector<Vec2>& points) {
    double best = 0.0;
    double least = infinite;
    for (int i = 0; i < box_turns; ++i) {
        const double angle = 0.5 * pi * i / box_turns;
        const double area = turned_size(points, angle).prod();
        if (area < least * (1.0 - 1e-9)) {
            least = area;
            best = angle;
        }
    }
    return best;
}

// The poses that fit on an empty sheet: images of far larger ones would take all memory there is.
std::vector<pack::FitImage> poses_of(const SheetPiece& piece, const NestingOptions& options,
                                     double cell) {
    const bool grows = options.height <= 0.0;
    const pack::Outline outline = pack::outline_of(piece.cut);
    double angle = least_box_angle(outline.hull);
    int turns = 4;
    const Vec2 grain = piece.grain_line[1] - piece.grain_line[0];
    if (options.keep_grain && grain != Vec2::Zero()) {
        angle = 0.5 * pi - std::atan2(grain.y(), grain.x());
        turns = 2;
    }
    std::vector<pack::FitImage> poses;
    for (int i = 0; i < turns; ++i) {
        const double turn = angle + 2.0 * pi * i / turns;
        const Vec2 size = turned_size(outline.hull, turn);
        if (size.x() > options.width + cell || (!grows && size.y() > options.height + cell))
            continue;
        poses.emplace_back(pack::rasterize(outline, turn, cell, 0.5 * options.gap));
    }
    return poses;
}

double box_area(const SheetPiece& piece) {
    return piece.box().sizes().prod();
}

// Nesting by outline covers about this share of a sheet.
constexpr double covered_share = 0.7;

Eigen::AlignedBox2d box_of(const std::vector<SheetPiece>& pieces) {
    Eigen::AlignedBox2d box;
    for (const SheetPiece& piece : pieces)
        box.extend(piece.box());
    return box;
}

// Whether cut lines of different pieces have a point in common, or a piece lies in another.
bool pieces_touch(const std::vector<SheetPiece>& pieces) {
    const Eigen::AlignedBox2d box = box_of(pieces);
    SegmentGrid grid(box, 0.01 * box.sizes().maxCoeff());
    for (std::size_t i = 0; i < pieces.size(); ++i)
        for (const std::vector<Vec2>& ring : pieces[i].cut) {
            if (grid.ring_touches(ring, static_cast<Index>(i)))
                return true;
            grid.add_ring(ring, static_cast<Index>(i));
        }
    std::vector<Eigen::AlignedBox2d> boxes;
    for (const SheetPiece& piece : pieces)
        boxes.push_back(piece.box());
    plane::BoxGrid all(boxes);
    for (std::size_t i = 0; i < pieces.size(); ++i)
        all.add(static_cast<Index>(i));
    for (std::size_t j = 0; j < pieces.size(); ++j)
        if (all.any_touching({boxes[j].min(), boxes[j].min()}, [&](Index i) {
                return at(i) != j && boxes[at(i)].contains(boxes[j]) &&
                       plane::is_inside(pieces[at(i)].cut, pieces[j].cut.front().front());
            }))
            return true;
    return false;
}

// One sheet that is about as high as wide.
void nest_freely(PatternLayout& layout, bool keep_grain, double bleed, Progress& progress) {
    double area = 0.0;
    double widest = 0.0;
    std::vector<const SheetPiece*> pieces;
    for (const SheetPiece& piece : layout.pieces) {
        pieces.push_back(&piece);
        area += std::abs(plane::signed_area(piece.cut.front()));
        widest = std::max(widest, piece.box().sizes().norm());
    }
    NestingOptions nesting;
    const double side = std::max(std::sqrt(area / covered_share), widest);
    nesting.gap = std::max(bleed, std::min(piece_gap, pattern::gap_share * side));
    nesting.width = side + nesting.gap;
    nesting.keep_grain = keep_grain;
    const Nesting nested = nest_pieces(pieces, nesting, progress);
    for (std::size_t i = 0; i < layout.pieces.size(); ++i)
        layout.pieces[i].move(nested.placements[i]);
}

// Each sheet as it is seen from its back.
void mirror_sheets(PatternLayout& layout) {
    for (SheetPiece& piece : layout.pieces)
        piece.mirror(0.5 * layout.sheets[piece.sheet].size.x());
}

// Lines that no text may cross: where pages end within their sheet, as paper is cut and glued
// there, and the crosses in the strips. For each sheet.
std::vector<std::vector<std::array<Vec2, 2>>> page_borders(const PatternLayout& layout) {
    std::vector<std::vector<std::array<Vec2, 2>>> borders(layout.sheets.size());
    for (std::size_t s = 0; s < borders.size() && layout.page; ++s) {
        const PatternSheet& sheet = layout.sheets[s];
        const double margin = layout.page->margin;
        const auto add = [&](Index pages, int axis) {
            for (Index k = 1; k < pages; ++k)
                for (const double strip : {-margin, 0.0, tile_overlap, tile_overlap + margin}) {
                    Vec2 from = Vec2::Zero();
                    from[axis] = margin + k * layout.page->step()[axis] + strip;
                    Vec2 to = from;
                    to[1 - axis] = sheet.size[1 - axis];
                    borders[s].push_back({from, to});
                }
        };
        add(sheet.columns, 0);
        add(sheet.rows, 1);
        for (const Vec2& place : strip_crosses(sheet, *layout.page))
            for (const Vec2& arm : {Vec2(cross_arm, 0.0), Vec2(0.0, cross_arm)})
                borders[s].push_back({place - arm, place + arm});
    }
    return borders;
}

// All pieces in their places, without texts.
PatternLayout place_pieces(const pattern::Pattern& pattern, const ExportOptions& options,
                           Progress& progress) {
    PatternLayout layout;
    layout.assembly = assembly::plan_assembly(pattern, options.craft(), progress);
    layout.page = page_format(options);
    GlueTabs tabs;
    tabs.tabs.resize(pattern.pieces.size());
    auto tabbing = progress.part("glue tabs", 0.1);
    if (options.glue_tabs)
        tabs =
            make_tabs(pattern, {options.tab_depth_mm, options.tabs, options.border_tabs}, tabbing);
    layout.seams_without_tab = tabs.seams_without;
    for (std::size_t i = 0; i < pattern.pieces.size() && options.glue_tabs; ++i)
        if (2.0 * pattern.pieces[i].label_radius < least_glued_width)
            layout.narrow.push_back(static_cast<Index>(i));
    auto drawing = progress.part("drawing pieces", 0.1);
    for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
        drawing.update(static_cast<double>(i) / static_cast<double>(pattern.pieces.size()));
        layout.pieces.push_back(compose_piece(pattern, static_cast<Index>(i), tabs, options));
        if (options.marks_openings())
            add_openings(pattern, layout.assembly, layout.pieces.back());
    }
    auto laying = progress.part("laying out sheets", 0.8);
    if (options.is_marker()) {
        lay_out_marker(pattern, options, layout, laying);
        return layout;
    }
    if (layout.page) {
        const PageNesting nesting =
            nest_on_pages(layout.pieces, *layout.page, options.tiling, laying);
        layout.sheets = nesting.sheets;
        for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
            layout.pieces[i].move(nesting.placements[i]);
            layout.pieces[i].sheet = nesting.sheet[i];
        }
        return layout;
    }
    const bool keep_grain = options.grain_line && options.grain != pattern::GrainDirection::free;
    if (options.glue_tabs || options.allowance().largest() > 0.0 || options.bleed() > 0.0 ||
        pieces_touch(layout.pieces))
        nest_freely(layout, keep_grain, options.bleed(), laying);
    const Eigen::AlignedBox2d box = box_of(layout.pieces);
    const pack::Placement shift{1.0, 0.0, Vec2::Constant(sheet_margin) - box.min()};
    for (SheetPiece& piece : layout.pieces)
        piece.move(shift);
    // Whole millimetres keep y exact when writers turn the sheet over.
    const Vec2 size(std::ceil(box.sizes().x()), std::ceil(box.sizes().y()));
    layout.sheets.push_back({size + Vec2::Constant(2.0 * sheet_margin), 1, 1});
    return layout;
}

} // namespace

Nesting nest_pieces(const std::vector<const SheetPiece*>& pieces, const NestingOptions& options,
                    Progress& progress) {
    const double cell = options.width / pack::sheet_cells;
    // Half of the gap around each piece may lie outside of the sheet.
    const auto cells = [&](double length) {
        return static_cast<Index>(std::floor((length + options.gap) / cell));
    };
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return box_area(*pieces[a]) > box_area(*pieces[b]);
    });
    Nesting nesting;
    nesting.placements.resize(pieces.size());
    nesting.sheet.assign(pieces.size(), -1);
    std::vector<pack::FreeCells> sheets;
    const Index columns = cells(options.width);
    const Index limit =
        options.height > 0.0 ? cells(options.height) + 1 : std::numeric_limits<Index>::max();
    std::size_t done = 0;
    for (const std::size_t i : order) {
        progress.update(static_cast<double>(done++) / static_cast<double>(order.size()));
        const std::vector<pack::FitImage> poses = poses_of(*pieces[i], options, cell);
        pack::Spot spot;
        auto sheet = std::find_if(sheets.begin(), sheets.end(), [&](pack::FreeCells& free) {
            return free.put(poses, 0, limit, spot);
        });
        if (sheet == sheets.end()) {
            pack::FreeCells fresh(columns, columns);
            if (!fresh.put(poses, 0, limit, spot))
                continue; // larger than a sheet
            sheet = sheets.insert(sheets.end(), std::move(fresh));
        }
        nesting.sheet[i] = static_cast<Index>(sheet - sheets.begin());
        nesting.placements[i] = pack::placement_of(poses[spot.pose].cells, spot, cell);
        nesting.placements[i].offset -= Vec2::Constant(0.5 * options.gap);
    }
    nesting.sheet_count = static_cast<Index>(sheets.size());
    return nesting;
}

std::vector<Vec2> strip_crosses(const PatternSheet& sheet, const PageFormat& page) {
    std::vector<Vec2> places;
    const auto add = [&](Index strips, Index pages, int axis) {
        for (Index k = 1; k < strips; ++k)
            for (Index j = 0; j < pages; ++j)
                for (const double share : {0.25, 0.75}) {
                    Vec2 place;
                    place[axis] = page.margin + k * page.step()[axis] + 0.5 * tile_overlap;
                    place[1 - axis] = page.margin + j * page.step()[1 - axis] +
                                      share * page.printable()[1 - axis];
                    places.push_back(place);
                }
    };
    add(sheet.columns, sheet.rows, 0);
    add(sheet.rows, sheet.columns, 1);
    return places;
}

PatternLayout lay_out_pattern(const pattern::Pattern& pattern, const ExportOptions& options,
                              Progress& progress) {
    PatternLayout layout = place_pieces(pattern, options, progress);
    if (options.mirror)
        mirror_sheets(layout);
    layout.left_out =
        add_texts(pattern, layout.assembly, options, layout.pieces, page_borders(layout));
    return layout;
}

std::vector<std::string> layout_notes(const pattern::Pattern& pattern,
                                      const PatternLayout& layout) {
    std::vector<std::string> notes;
    const auto note = [&](std::size_t count, std::size_t all, const char* one, const char* many,
                          const char* what) {
        if (count > 0)
            notes.push_back(std::to_string(count) + " of " + std::to_string(all) +
                            (all == 1 ? one : many) + (count == 1 ? " has " : " have ") + what);
    };
    note(at(layout.seams_without_tab), pattern.seams.size(), " seam", " seams",
         "no glue tab: there is no room beside them on either side");
    note(layout.left_out.seams.size(), pattern.seams.size(), " seam", " seams",
         "no room for a number that can be read: the cover of a PDF names them");
    note(layout.left_out.pieces.size(), pattern.pieces.size(), " piece", " pieces",
         "no room for a name that can be read: the cover of a PDF names them");
    std::string names;
    for (std::size_t i = 0; i < layout.narrow.size() && i < most_names; ++i)
        names += (i > 0 ? ", " : " (") + pattern.pieces[layout.narrow[i]].name;
    note(layout.narrow.size(), pattern.pieces.size(), " piece", " pieces",
         ("less than 3 mm at the widest place" + names +
          (layout.narrow.size() > most_names ? ", ...)" : ")") +
          ": make the model larger, or give fewer charts or faces")
             .c_str());
    Index single = 0;
    for (const FabricStrip& fabric : layout.fabrics)
        single += fabric.single_layer_pieces;
    if (single > 0)
        notes.push_back(std::to_string(single) +
                        " of the pieces on folded cloth have neither a mirror image nor an axis "
                        "along the grain: cut them from the upper layer alone");
    return notes;
}

} // namespace devseg::sheet
