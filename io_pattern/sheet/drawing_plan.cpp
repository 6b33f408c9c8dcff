#include "sheet/drawing_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "devseg/plane/plane.h"
#include "sheet/page_nesting.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    double text = 8.0;  // mm, font size in check squares
    double step = 5.0;  // mm between places that are tried for a check square
    double clear = 2.0; // mm that it keeps to pieces
};
constexpr Tuning tuning;

bool touches(const std::vector<Vec2>& ring, const Eigen::AlignedBox2d& box) {
    const std::vector<Vec2> corners = rectangle(box.min(), box.sizes()).points;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2& a = ring[i];
        const Vec2& b = ring[(i + 1) % ring.size()];
        if (!box.intersects(Eigen::AlignedBox2d(a).extend(b)))
            continue;
        if (box.contains(a))
            return true;
        for (std::size_t k = 0; k < 4; ++k)
            if (plane::segments_touch(a, b, corners[k], corners[(k + 1) % 4]))
                return true;
    }
    return plane::is_inside(ring, box.center()); // a page within a piece
}

void add_square(const CheckSquare& square, const std::string& id, const Vec2& place,
                writers::DrawingLayer& layer) {
    const Vec2 side = Vec2::Constant(square.side);
    layer.paths.push_back({id, {rectangle(place, side)}});
    layer.texts.push_back({place + 0.5 * side, tuning.text, square.text});
}

// On the page in the coordinates of its sheet, from the lower left on: clear of all pieces, or
// across as few as possible.
Vec2 place_for_square(const PatternLayout& layout, const PrintedPage& page, const Vec2& low) {
    const double side = check_squares[0].side;
    const Vec2 room = page.window.size - Vec2::Constant(side);
    Vec2 best = low;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (double y = 0.0; y <= room.y() && fewest > 0; y += tuning.step)
        for (double x = 0.0; x <= room.x() && fewest > 0; x += tuning.step) {
            const Vec2 place = low + Vec2(x, y);
            const Eigen::AlignedBox2d box(place - Vec2::Constant(tuning.clear),
                                          place + Vec2::Constant(side + tuning.clear));
            std::size_t count = 0;
            for (const Index p : page.pieces)
                count += touches(layout.pieces[at(p)].cut.front(), box) ? 1 : 0;
            if (count < fewest) {
                fewest = count;
                best = place;
            }
        }
    return best;
}

void add_pages(const PatternLayout& layout, const std::vector<PrintedPage>& pages,
               const writers::Drawing& drawing, const ExportOptions& options,
               writers::DrawingLayer& layer) {
    for (std::size_t i = 0; i < pages.size(); ++i) {
        const PrintedPage& page = pages[i];
        const std::string number = pages.size() > 1 ? '-' + std::to_string(i + 1) : "";
        if (options.frame)
            layer.paths.push_back(
                {"frame" + number, {rectangle(drawing.pages[i].low, drawing.pages[i].size)}});
        if (options.frame && layout.sheets[page.sheet].columns * layout.sheets[page.sheet].rows > 1)
            layer.paths.push_back(
                {"trim" + number, {rectangle(page.window.low, page.window.size)}});
        if (!options.scale_check || page.window.size.minCoeff() < check_squares[0].side)
            continue;
        const Vec2& sheet = drawing.sheets[page.sheet].low;
        add_square(check_squares[0], check_squares[0].id + number,
                   sheet + place_for_square(layout, page, page.window.low - sheet), layer);
    }
}

// In rows from above. Pages where nothing is, or only what others show, are left out.
std::vector<PrintedPage> pages_of_sheet(const PatternLayout& layout, Index s) {
    const PageFormat& format = *layout.page;
    const PatternSheet& sheet = layout.sheets[at(s)];
    const Index across = parts_of(sheet.columns);
    std::vector<std::vector<Index>> pieces; // on each part
    std::vector<Index> amounts;
    for (Index part = 0; part < across * parts_of(sheet.rows); ++part) {
        const Eigen::AlignedBox2d box = part_box(sheet, format, part % across, part / across);
        pieces.emplace_back();
        for (std::size_t p = 0; p < layout.pieces.size(); ++p)
            if (layout.pieces[p].sheet == s && touches(layout.pieces[p].cut.front(), box))
                pieces.back().push_back(static_cast<Index>(p));
        amounts.push_back(static_cast<Index>(pieces.back().size()));
    }
    const std::vector<Index> owner = cover_parts(sheet.columns, sheet.rows, amounts);
    std::vector<PrintedPage> pages;
    for (Index row = 0; row < sheet.rows; ++row)
        for (Index column = 0; column < sheet.columns; ++column) {
            const Index from_below = sheet.rows - 1 - row;
            std::set<Index> on_page;
            for (std::size_t part = 0; part < owner.size(); ++part)
                if (owner[part] == from_below * sheet.columns + column)
                    on_page.insert(pieces[part].begin(), pieces[part].end());
            if (on_page.empty())
                continue;
            const Vec2 margin = Vec2::Constant(format.margin);
            const Vec2 low = margin + Vec2(column, from_below).cwiseProduct(format.step());
            pages.push_back({{low, format.printable(), margin, 1.0},
                             s,
                             row,
                             column,
                             {on_page.begin(), on_page.end()}});
        }
    return pages;
}

} // namespace

writers::DrawingPolyline rectangle(const Vec2& low, const Vec2& size) {
    return {{low, low + Vec2(size.x(), 0.0), low + size, low + Vec2(0.0, size.y())}, true};
}

DrawingPlan plan_drawing(const PatternLayout& layout, bool scale_check) {
    DrawingPlan plan;
    Vec2 sheets(-sheet_gap, 0.0);
    for (const PatternSheet& sheet : layout.sheets)
        sheets =
            Vec2(sheets.x() + sheet_gap + sheet.size.x(), std::max(sheets.y(), sheet.size.y()));
    const bool has_strip = scale_check && !layout.page;
    const double strip = check_squares[1].side + sheet_margin;
    const double along = check_squares[0].side + check_squares[1].side + 3.0 * sheet_margin;
    const Vec2 below(std::max(sheets.x(), along), sheets.y() + strip);
    const Vec2 beside(sheets.x() + strip, std::max(sheets.y(), along));
    const bool is_below = has_strip && below.prod() <= beside.prod();
    plan.size = has_strip ? Vec2((is_below ? below : beside).array().ceil()) : sheets;
    double x = 0.0;
    for (const PatternSheet& sheet : layout.sheets) {
        plan.sheets.emplace_back(x, is_below ? std::ceil(strip) : 0.0);
        x += sheet.size.x() + sheet_gap;
    }
    if (!has_strip)
        return plan;
    const double step = check_squares[0].side + sheet_margin;
    const Vec2 first = is_below ? Vec2::Constant(sheet_margin) : Vec2(sheets.x(), sheet_margin);
    plan.squares = {first, first + (is_below ? Vec2(step, 0.0) : Vec2(0.0, step))};
    return plan;
}

writers::DrawingLayer scale_layer(const PatternLayout& layout, const DrawingPlan& plan,
                                  const std::vector<PrintedPage>& pages,
                                  const writers::Drawing& drawing, const ExportOptions& options) {
    writers::DrawingLayer layer{"scale", "Scale check", "#000000", {}, {}, {}};
    if (layout.page) {
        add_pages(layout, pages, drawing, options, layer);
        return layer;
    }
    if (options.frame)
        layer.paths.push_back({"frame", {rectangle(Vec2::Zero(), plan.size)}});
    for (std::size_t i = 0; i < plan.squares.size(); ++i)
        add_square(check_squares[i], check_squares[i].id, plan.squares[i], layer);
    return layer;
}

std::vector<PrintedPage> printed_pages(const PatternLayout& layout,
                                       const writers::Drawing& drawing) {
    if (!layout.page)
        return {
            {{Vec2::Zero(), Vec2(drawing.width, drawing.height), Vec2::Zero(), 1.0}, 0, 0, 0, {}}};
    std::vector<PrintedPage> pages;
    for (Index s = 0; s < static_cast<Index>(layout.sheets.size()); ++s)
        for (PrintedPage& page : pages_of_sheet(layout, s)) {
            page.window.low += drawing.sheets[at(s)].low;
            pages.push_back(std::move(page));
        }
    return pages;
}

} // namespace devseg::sheet
