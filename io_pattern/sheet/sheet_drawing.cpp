#include "sheet/sheet_drawing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/plane/box_grid.h"
#include "devseg/plane/plane.h"
#include "sheet/drawing_plan.h"
#include "sheet/marker.h"
#include "sheet/marks.h"
#include "sheet/sizes.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

// Three decimals (1 µm) are far below what a blade can follow. Small patterns, such as models in
// metres exported at 1 mm for a unit, need more. The grid is to be at most this share of the
// layout's size, and rounding may change the area of no piece by more than the second share
// (0.1 % is promised). Pieces below a millionth of the whole are measured against that millionth:
// nobody cuts them.
constexpr int usual_decimals = 3;
constexpr double grid_share = 1e-4;
constexpr double area_tolerance = 2e-4;
constexpr double negligible_piece = 1e-6;

constexpr double caption_share = 0.32;  // of the margin: font size
constexpr double largest_caption = 3.2; // mm
constexpr double least_caption = 1.2;
constexpr double page_title = 6.0;
constexpr double page_text = 3.5;
constexpr double overview_share = 0.55; // of a page: less than that is too small for the overview

// Area of a path whose points are rounded to the grid; as they are for a grid of 0.
double area_of(const writers::DrawingPath& path, double grid) {
    double twice = 0.0;
    for (const writers::DrawingPolyline& part : path.parts) {
        const auto rounded = [&](std::size_t i) {
            const Vec2& p = part.points[i];
            return grid > 0.0
                       ? Vec2(std::round(p.x() / grid) * grid, std::round(p.y() / grid) * grid)
                       : p;
        };
        const Vec2 first = rounded(0);
        for (std::size_t i = 2; i < part.points.size(); ++i)
            twice += plane::cross(rounded(i - 1) - first, rounded(i) - first);
    }
    return 0.5 * twice;
}

int decimals_for(const writers::DrawingLayer& cut) {
    double total = 0.0;
    Eigen::AlignedBox2d box;
    std::vector<double> areas;
    for (const writers::DrawingPath& path : cut.paths) {
        areas.push_back(path.parts.front().closed ? std::abs(area_of(path, 0.0)) : 0.0);
        total += areas.back();
        for (const writers::DrawingPolyline& part : path.parts)
            for (const Vec2& p : part.points)
                box.extend(p);
    }
    const auto holds = [&](double grid) {
        for (std::size_t i = 0; i < cut.paths.size(); ++i) {
            const double allowed = area_tolerance * std::max(areas[i], negligible_piece * total);
            if (areas[i] > 0.0 &&
                std::abs(std::abs(area_of(cut.paths[i], grid)) - areas[i]) > allowed)
                return false;
        }
        return true;
    };
    const double finest = grid_share * box.sizes().maxCoeff();
    int decimals = usual_decimals;
    // More digits than a double holds next to the margin say nothing.
    while (decimals < std::numeric_limits<double>::digits10 &&
           (std::pow(10.0, -decimals) > finest || !holds(std::pow(10.0, -decimals))))
        ++decimals;
    return decimals;
}

// One path, whose parts are the lines.
void add_lines(const std::vector<std::vector<Vec2>>& lines, bool closed, const SheetPiece& piece,
               const char* kind, writers::DrawingLayer& layer) {
    writers::DrawingPath path{piece.name + kind, {}, piece.name};
    for (const std::vector<Vec2>& line : lines)
        path.parts.push_back({line, closed});
    if (!path.parts.empty())
        layer.paths.push_back(std::move(path));
}

// The same for closed lines that may be curves. Holes come before the outline: what a laser has cut
// loose lies still no more.
void add_rings(const std::vector<std::vector<Vec2>>& rings,
               const std::vector<std::vector<pattern::OutlineCurve>>& curves,
               const SheetPiece& piece, const char* kind, writers::DrawingLayer& layer) {
    writers::DrawingPath path{piece.name + kind, {}, piece.name};
    const auto add = [&](std::size_t i) {
        path.parts.push_back({rings[i], true});
        if (i < curves.size())
            for (const pattern::OutlineCurve& curve : curves[i])
                path.parts.back().curves.push_back({curve.control, curve.is_line});
    };
    for (std::size_t i = 1; i < rings.size(); ++i)
        add(i);
    if (!rings.empty())
        add(0);
    if (!path.parts.empty())
        layer.paths.push_back(std::move(path));
}

// Positions in the layout, those that lie in a hole of another piece before that piece: once the
// hole is cut, they would fall out with what was in it.
std::vector<std::size_t> cutting_order(const std::vector<SheetPiece>& pieces) {
    std::vector<Eigen::AlignedBox2d> boxes;
    for (const SheetPiece& piece : pieces)
        boxes.push_back(piece.box());
    std::vector<int> depth(pieces.size(), 0);
    std::vector<std::size_t> order;
    plane::BoxGrid with_holes(boxes);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        order.push_back(i);
        if (pieces[i].cut.size() > 1)
            with_holes.add(static_cast<Index>(i));
    }
    for (std::size_t i = 0; i < pieces.size(); ++i)
        with_holes.any_touching({boxes[i].min(), boxes[i].min()}, [&](Index j) {
            const SheetPiece& other = pieces[at(j)];
            if (at(j) != i && other.sheet == pieces[i].sheet && boxes[at(j)].contains(boxes[i]) &&
                plane::is_inside(other.cut.front(), pieces[i].cut.front().front()))
                ++depth[i];
            return false; // all of them count
        });
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return depth[a] > depth[b]; });
    return order;
}

void add_notches(const SheetPiece& piece, NotchKind kind, writers::DrawingLayer& layer) {
    std::vector<std::vector<Vec2>> lines;
    for (const SheetNotch& notch : piece.notches)
        lines.push_back(notch.line(kind));
    add_lines(lines, false, piece, "-notch", layer);
}

writers::DrawingPolyline segment(const Vec2& a, const Vec2& b) {
    return {{a, b}, false};
}

constexpr double underline_gap = 0.12; // of the font size, below the digits

// Below numbers that are others upside down.
void add_underlines(const SheetPiece& piece, writers::DrawingLayer& layer) {
    std::vector<std::vector<Vec2>> lines;
    for (const writers::DrawingText& text : piece.numbers) {
        if (!is_ambiguous(text.text))
            continue;
        const Vec2 along(std::cos(text.angle), std::sin(text.angle));
        const Vec2 foot = text.position - (0.5 * writers::capital_height + underline_gap) *
                                              text.size * plane::left_of(along);
        const Vec2 half = 0.5 * writers::text_width(text.text, text.size) * along;
        lines.push_back({foot - half, foot + half});
    }
    add_lines(lines, false, piece, "-underline", layer);
}

// The squares to check the scale with, side by side.
void add_squares(const Vec2& low, double gap, writers::DrawingLayer& marks) {
    double x = low.x();
    for (const CheckSquare& square : check_squares) {
        const Vec2 side = Vec2::Constant(square.side);
        marks.paths.push_back({"", {rectangle(Vec2(x, low.y()), side)}});
        marks.texts.push_back({Vec2(x, low.y()) + 0.5 * side, page_text, square.text});
        x += square.side + gap;
    }
}

// Where the lowest line of text or picture of a page is.
double lowest_mark(const writers::DocumentPage& page) {
    double low = page.height;
    for (const writers::DrawingLayer& layer : page.marks)
        for (const writers::DrawingText& text : layer.texts)
            low = std::min(low, text.position.y() - 0.5 * text.size);
    for (const writers::DrawingImage& image : page.images)
        low = std::min(low, image.low.y());
    return low;
}

// In the lower margin: a bar to check the scale with, and what page this is.
void add_caption(const PatternLayout& layout, const PrintedPage& printed, std::size_t number,
                 std::size_t count, const std::string& title, writers::DrawingLayer& layer) {
    const PageFormat& page = *layout.page;
    const double size = std::min(largest_caption, caption_share * page.margin);
    if (size < least_caption)
        return;
    const PatternSheet& sheet = layout.sheets[printed.sheet];
    const double y = 0.45 * page.margin;
    const double bar = check_squares[0].side;
    const Vec2 from(page.size.x() - page.margin - bar, y + 0.6 * size);
    const Vec2 to = from + Vec2(bar, 0.0);
    const Vec2 tick(0.0, 0.3 * size);
    layer.paths.push_back(
        {"",
         {segment(from, to), segment(from - tick, from + tick), segment(to - tick, to + tick)}});
    layer.texts.push_back({from + Vec2(0.5 * bar, -0.8 * size), size, "50 mm, print at 100 %"});
    std::string caption = "page " + std::to_string(number) + " of " + std::to_string(count);
    if (sheet.columns * sheet.rows > 1)
        caption = "row " + std::to_string(printed.row + 1) + " column " +
                  std::to_string(printed.column + 1) + ", " + caption;
    // Long titles are cut off in front of the bar.
    const double room = page.printable().x() - bar - 2.0 * size;
    std::string name = title;
    while (!name.empty() && writers::text_width(name + ", " + caption, size) > room)
        name.pop_back();
    if (!name.empty())
        caption = name + ", " + caption;
    if (writers::text_width(caption, size) <= room)
        layer.texts.push_back(
            {Vec2(page.margin, y), size, caption, 0.0, writers::TextAnchor::left});
}

} // namespace

writers::Drawing draw_sheets(const PatternLayout& layout, const ExportOptions& options) {
    const DrawingPlan plan = plan_drawing(layout, options.scale_check);
    const bool laser = options.preset == PatternPreset::laser;
    writers::DrawingLayer cut{"cut", "Cut", "#ff0000", {}, {}, {}};
    writers::DrawingLayer mountain{"mountain", "Fold mountain", "#0000ff", {}, {}, {}};
    writers::DrawingLayer valley{"valley", "Fold valley", "#00aa00", {3.0, 1.5}, {}, {}};
    writers::DrawingLayer perforation{"perforation", "Perforation", "#ff8800", {}, {}, {}};
    writers::DrawingLayer shadow{"shadow", "Tab shadows", "#999999", {1.0, 1.0}, {}, {}};
    writers::DrawingLayer sew{"sew", "Sew line", "#00a000", {3.0, 1.5}, {}, {}};
    writers::DrawingLayer notch{"notch", "Notches", "#ff00ff", {}, {}, {}};
    writers::DrawingLayer grain{"grain", "Grain line", "#000000", {}, {}, {}};
    writers::DrawingLayer numbers{"numbers", "Seam numbers", "#000000", {}, {}, {}};
    writers::DrawingLayer text{"text", "Text", "#000000", {}, {}, {}};
    writers::DrawingLayer engrave{"engrave", "Engrave", "#0000ff", {}, {}, {}};
    for (const std::size_t i : cutting_order(layout.pieces)) {
        SheetPiece piece = layout.pieces[i];
        piece.move({1.0, 0.0, plan.sheets[piece.sheet]});
        add_lines(piece.slits, false, piece, "-slit", piece.has_allowance() ? sew : cut);
        add_rings(piece.cut, piece.cut_curves, piece, "-cut", cut);
        add_rings(piece.sew, piece.sew_curves, piece, "-sew", sew);
        add_lines(piece.mountains, false, piece, "-mountain", mountain);
        add_lines(piece.valleys, false, piece, "-valley", valley);
        add_lines(piece.perforations, false, piece, "-perforation", perforation);
        add_lines(piece.shadows, false, piece, "-shadow", shadow);
        add_lines(piece.grain, false, piece, "-grain", grain);
        add_notches(piece, options.notch_kind, notch);
        add_lines(piece.drills, false, piece, "-drill", notch);
        add_lines(piece.openings, false, piece, "-opening", notch);
        add_lines(piece.leaders, false, piece, "-leader", laser ? engrave : numbers);
        add_underlines(piece, laser ? engrave : numbers);
        for (const auto& [texts, layer] : {std::pair(&piece.names, laser ? &engrave : &text),
                                           std::pair(&piece.numbers, laser ? &engrave : &numbers)})
            for (writers::DrawingText written : *texts) {
                written.owner = piece.name;
                layer->texts.push_back(std::move(written));
            }
    }
    writers::Drawing drawing;
    drawing.width = plan.size.x();
    drawing.height = plan.size.y();
    drawing.decimals = decimals_for(cut);
    drawing.by_piece = options.group == Grouping::piece;
    for (std::size_t i = 0; i < layout.sheets.size() && layout.page; ++i)
        drawing.sheets.push_back({plan.sheets[i], layout.sheets[i].size});
    const std::vector<PrintedPage> pages = printed_pages(layout, drawing);
    for (std::size_t i = 0; i < pages.size() && layout.page; ++i)
        drawing.pages.push_back(
            {pages[i].window.low - pages[i].window.position, layout.page->size});
    drawing.layers = {
        cut,     perforation, mountain, valley,  shadow,
        sew,     notch,       grain,    engrave, scale_layer(layout, plan, pages, drawing, options),
        numbers, text};
    for (writers::DrawingLayer& layer : size_layers(layout, plan.sheets, options.notch_kind))
        drawing.layers.push_back(std::move(layer));
    if (!layout.fabrics.empty())
        drawing.layers.push_back(fabric_layer(layout, plan.sheets));
    return drawing;
}

std::vector<writers::DocumentPage> page_sheets(const PatternLayout& layout,
                                               const writers::Drawing& drawing,
                                               const std::vector<PrintedPage>& pages,
                                               const std::string& title) {
    std::vector<writers::DocumentPage> result;
    for (std::size_t i = 0; i < pages.size(); ++i) {
        writers::DocumentPage page;
        page.windows = {pages[i].window};
        if (!layout.page) {
            page.width = drawing.width;
            page.height = drawing.height;
            result.push_back(std::move(page));
            continue;
        }
        page.width = layout.page->size.x();
        page.height = layout.page->size.y();
        writers::DrawingLayer marks{"page", "Page marks", "#666666", {}, {}, {}};
        marks.paths.push_back(
            {"", {rectangle(pages[i].window.position, layout.page->printable())}});
        const Eigen::AlignedBox2d shown(pages[i].window.low,
                                        pages[i].window.low + pages[i].window.size);
        for (const Vec2& place : strip_crosses(layout.sheets[pages[i].sheet], *layout.page)) {
            const Vec2 in_drawing = drawing.sheets[at(pages[i].sheet)].low + place;
            if (!shown.contains(in_drawing))
                continue;
            const Vec2 p = in_drawing - pages[i].window.low + pages[i].window.position;
            const Vec2 x(cross_arm, 0.0), y(0.0, cross_arm);
            marks.paths.push_back({"", {segment(p - x, p + x), segment(p - y, p + y)}});
        }
        add_caption(layout, pages[i], i + 1, pages.size(), title, marks);
        page.marks = {std::move(marks)};
        result.push_back(std::move(page));
    }
    return result;
}

void add_overview(const PatternLayout& layout, const writers::Drawing& drawing,
                  const std::vector<PrintedPage>& pages, const std::string& title,
                  std::vector<writers::DocumentPage>& document) {
    const PageFormat& format = *layout.page;
    const Vec2 low = Vec2::Constant(format.margin);
    double top = format.size.y() - format.margin;
    const double free = document.empty() ? 0.0 : lowest_mark(document.back()) - page_title;
    if (free - low.y() >= overview_share * format.printable().y()) {
        top = free;
    } else {
        document.emplace_back();
        document.back().width = format.size.x();
        document.back().height = format.size.y();
        document.back().marks.push_back({"page", "Page marks", "#666666", {}, {}, {}});
    }
    writers::DocumentPage& page = document.back();
    writers::DrawingLayer& marks = page.marks.front();
    Vec2 room(format.printable().x(), top - low.y());
    const double squares = check_squares[0].side + check_squares[1].side + format.margin;
    const double foot = check_squares[1].side + 2.0 * page_text;
    const bool has_squares = room.x() >= squares && room.y() >= 2.5 * foot;
    if (has_squares) {
        add_squares(low, format.margin, marks);
        room.y() -= foot;
    }
    room.y() -= 2.0 * page_title;
    marks.texts.push_back({Vec2(low.x(), top - 0.5 * page_title), page_title,
                           title + ": overview, not to scale", 0.0, writers::TextAnchor::left});
    // Sheets in rows and columns, all at one scale.
    const std::size_t count = layout.sheets.size();
    const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
    const std::size_t rows = (count + columns - 1) / columns;
    const Vec2 cell(room.x() / static_cast<double>(columns), room.y() / static_cast<double>(rows));
    double scale = 1.0;
    for (const PatternSheet& sheet : layout.sheets)
        scale = std::min(scale, 0.95 * cell.cwiseQuotient(sheet.size).minCoeff());
    std::vector<Vec2> places;
    for (std::size_t s = 0; s < count; ++s) {
        const writers::DrawingSheet& sheet = drawing.sheets[s];
        const Vec2 place(low.x() + cell.x() * static_cast<double>(s % columns),
                         top - 2.0 * page_title - cell.y() * static_cast<double>(s / columns) -
                             scale * sheet.size.y());
        page.windows.push_back({sheet.low, sheet.size, place, scale});
        places.push_back(place);
    }
    for (std::size_t i = 0; i < pages.size(); ++i) {
        const std::size_t s = at(pages[i].sheet);
        const Vec2 corner = places[s] + scale * (pages[i].window.low - drawing.sheets[s].low);
        const Vec2 size = scale * format.printable();
        marks.paths.push_back({"", {rectangle(corner, size)}});
        const double font = std::min(page_title, 0.3 * size.minCoeff());
        marks.texts.push_back({corner + Vec2(0.6 * font, size.y() - 0.7 * font), font,
                               std::to_string(i + 1), 0.0, writers::TextAnchor::left});
    }
}

} // namespace devseg::sheet
