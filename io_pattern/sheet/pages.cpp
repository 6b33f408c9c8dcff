#include "sheet/pages.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"
#include "sheet/segment_grid.h"
#include "writers/text_metrics.h"

namespace devseg::sheet {

namespace {

constexpr double caption_share = 0.32;  // of the margin: font size
constexpr double largest_caption = 3.2; // mm
constexpr double least_caption = 1.2;
constexpr double bar = 50.0;  // mm
constexpr double cross = 2.5; // mm, half the size of a registration cross
constexpr double check_squares[] = {50.0, 50.8};
constexpr double title_size = 6.0;
constexpr double text_size = 3.5;

writers::DrawingPolyline segment(const Vec2& a, const Vec2& b) {
    return {{a, b}, false};
}

writers::DrawingPolyline rectangle(const Vec2& low, const Vec2& size) {
    return {{low, low + Vec2(size.x(), 0.0), low + size, low + Vec2(0.0, size.y())}, true};
}

bool touches_window(const std::vector<Vec2>& ring, const writers::PageWindow& window) {
    const Eigen::AlignedBox2d box(window.low, window.low + window.size);
    const std::vector<Vec2> corners = rectangle(window.low, window.size).points;
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

// Crosses in the middle of the strips that a page shares with its neighbours, in the drawing.
std::vector<Vec2> cross_places(const PatternSheet& sheet, const PageFormat& page,
                               const PrintedPage& printed) {
    const Vec2 half = Vec2::Constant(0.5 * tile_overlap);
    const Vec2 low = printed.window.low;
    const Vec2 high = low + printed.window.size;
    std::vector<Vec2> places;
    for (const double share : {0.25, 0.75}) {
        const Vec2 inner = low + share * page.printable();
        if (printed.column > 0)
            places.emplace_back(low.x() + half.x(), inner.y());
        if (printed.column + 1 < sheet.columns)
            places.emplace_back(high.x() - half.x(), inner.y());
        if (printed.row + 1 < sheet.rows)
            places.emplace_back(inner.x(), low.y() + half.y());
        if (printed.row > 0)
            places.emplace_back(inner.x(), high.y() - half.y());
    }
    return places;
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

std::vector<PrintedPage> printed_pages(const PatternLayout& layout,
                                       const writers::Drawing& drawing) {
    if (!layout.page)
        return {
            {{Vec2::Zero(), Vec2(drawing.width, drawing.height), Vec2::Zero(), 1.0}, 0, 0, 0, {}}};
    const PageFormat& format = *layout.page;
    std::vector<PrintedPage> pages;
    for (std::size_t s = 0; s < layout.sheets.size(); ++s) {
        const PatternSheet& sheet = layout.sheets[s];
        for (Index row = 0; row < sheet.rows; ++row)
            for (Index column = 0; column < sheet.columns; ++column) {
                PrintedPage page;
                page.sheet = static_cast<Index>(s);
                page.row = row;
                page.column = column;
                const Vec2 low = Vec2::Constant(format.margin) +
                                 Vec2(column, sheet.rows - 1 - row).cwiseProduct(format.step());
                page.window = {low, format.printable(), Vec2::Constant(format.margin), 1.0};
                for (std::size_t p = 0; p < layout.pieces.size(); ++p)
                    if (layout.pieces[p].sheet == page.sheet &&
                        touches_window(layout.pieces[p].cut.front(), page.window))
                        page.pieces.push_back(static_cast<Index>(p));
                page.window.low += drawing.sheets[s].low;
                if (!page.pieces.empty())
                    pages.push_back(page);
            }
    }
    return pages;
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
        for (const Vec2& place :
             cross_places(layout.sheets[pages[i].sheet], *layout.page, pages[i])) {
            const Vec2 p = place - pages[i].window.low + pages[i].window.position;
            marks.paths.push_back({"",
                                   {segment(p - Vec2(cross, 0.0), p + Vec2(cross, 0.0)),
                                    segment(p - Vec2(0.0, cross), p + Vec2(0.0, cross))}});
        }
        add_caption(layout, pages[i], i + 1, pages.size(), title, marks);
        page.marks = {std::move(marks)};
        result.push_back(std::move(page));
    }
    return result;
}

writers::DocumentPage overview_page(const PatternLayout& layout, const writers::Drawing& drawing,
                                    const std::vector<PrintedPage>& pages,
                                    const std::string& title) {
    const PageFormat& format = *layout.page;
    writers::DocumentPage page;
    page.width = format.size.x();
    page.height = format.size.y();
    writers::DrawingLayer marks{"page", "Page marks", "#666666", {}, {}, {}};
    const Vec2 low = Vec2::Constant(format.margin);
    Vec2 room = format.printable();
    const double squares = check_squares[0] + check_squares[1] + format.margin;
    const double foot = check_squares[1] + 2.0 * text_size;
    const bool has_squares = room.x() >= squares && room.y() >= 2.5 * foot;
    if (has_squares) {
        double x = low.x();
        for (const double side : check_squares) {
            marks.paths.push_back({"", {rectangle(Vec2(x, low.y()), Vec2::Constant(side))}});
            marks.texts.push_back({Vec2(x, low.y()) + Vec2::Constant(0.5 * side), text_size,
                                   side == 50.0 ? "50 mm" : "2 inch"});
            x += side + format.margin;
        }
        room.y() -= foot;
    }
    room.y() -= 2.0 * title_size;
    const double top = format.size.y() - format.margin;
    marks.texts.push_back({Vec2(low.x(), top - 0.5 * title_size), title_size,
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
                         top - 2.0 * title_size - cell.y() * static_cast<double>(s / columns) -
                             scale * sheet.size.y());
        page.windows.push_back({sheet.low, sheet.size, place, scale});
        places.push_back(place);
    }
    for (std::size_t i = 0; i < pages.size(); ++i) {
        const std::size_t s = at(pages[i].sheet);
        const Vec2 corner = places[s] + scale * (pages[i].window.low - drawing.sheets[s].low);
        const Vec2 size = scale * format.printable();
        marks.paths.push_back({"", {rectangle(corner, size)}});
        const double font = std::min(title_size, 0.3 * size.minCoeff());
        marks.texts.push_back({corner + Vec2(0.6 * font, size.y() - 0.7 * font), font,
                               std::to_string(i + 1), 0.0, writers::TextAnchor::left});
    }
    page.marks = {std::move(marks)};
    return page;
}

} // namespace devseg::sheet
