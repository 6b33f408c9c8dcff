#include "sheet/cover.h"

#include <algorithm>
#include <cmath>

#include "sheet/model_view.h"
#include "writers/number_text.h"
#include "writers/text_metrics.h"

namespace devseg::sheet {

namespace {

const Vec2 a4(210.0, 297.0);
constexpr double margin = 10.0;    // mm, where no page says otherwise
constexpr double title_size = 7.0; // mm
constexpr double text_size = 3.2;
constexpr double line_pitch = 4.6;
constexpr double picture_share = 0.45; // of the page's height at most
constexpr int picture_pixels = 480;
constexpr double largest_label = 4.0;
constexpr double least_label = 1.6;
constexpr double azimuths[] = {-35.0 * pi / 180.0, 145.0 * pi / 180.0}; // front, back

// Where the columns of the table start, as shares of the width.
constexpr double columns[] = {0.0, 0.1, 0.26, 0.36, 0.56};

struct Row {
    std::array<std::string, 4> cells; // piece, size, page, how many to cut
    std::string seams;
};

std::string page_list(Index piece, const std::vector<PrintedPage>& pages) {
    std::string text;
    for (std::size_t i = 0; i < pages.size(); ++i)
        if (std::count(pages[i].pieces.begin(), pages[i].pieces.end(), piece) > 0)
            text += (text.empty() ? "" : ", ") + std::to_string(i + 1);
    return text.empty() ? "1" : text;
}

std::string cut_text(const pattern::PatternPiece& piece, const pattern::Pattern& pattern) {
    if (piece.model >= 0 && (piece.mirrored || piece.quantity == 0))
        return (piece.mirrored ? "mirrored " : "same as ") + pattern.pieces[piece.model].name;
    std::string text = std::to_string(std::max(Index{1}, piece.quantity));
    if (piece.mirrored_quantity > 0)
        text += " + " + std::to_string(piece.mirrored_quantity) + " mirrored";
    return text;
}

// The numbers of the seams to each neighbour: "P02: 1, 9; P03: 5".
std::string seam_list(const pattern::Pattern& pattern, Index piece) {
    std::vector<std::pair<std::string, std::string>> numbers_to;
    for (const pattern::Seam& seam : pattern.seams) {
        const Index a = seam.sides[0].piece;
        const Index b = seam.sides[1].piece;
        if (a != piece && b != piece)
            continue;
        const Index other = a == piece ? b : a;
        const std::string name = seam.is_dart     ? "dart"
                                 : other == piece ? "itself"
                                                  : pattern.pieces[other].name;
        const auto entry = std::find_if(numbers_to.begin(), numbers_to.end(),
                                        [&](const auto& known) { return known.first == name; });
        if (entry == numbers_to.end())
            numbers_to.emplace_back(name, name + ": " + seam.label);
        else
            entry->second += ", " + seam.label;
    }
    std::string text;
    for (const auto& [name, numbers] : numbers_to)
        text += (text.empty() ? "" : "; ") + numbers;
    return text;
}

std::vector<Row> table_rows(const pattern::Pattern& pattern, const PatternLayout& layout,
                            const std::vector<PrintedPage>& pages) {
    std::vector<Row> rows;
    for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
        const SheetPiece& drawn = layout.pieces[i];
        const pattern::PatternPiece& piece = pattern.pieces[drawn.piece];
        const Vec2 size = drawn.box().sizes();
        rows.push_back(
            {{piece.name,
              writers::number_text(size.x(), 0) + " x " + writers::number_text(size.y(), 0),
              page_list(static_cast<Index>(i), pages), cut_text(piece, pattern)},
             seam_list(pattern, drawn.piece)});
    }
    return rows;
}

// What the pieces themselves do not say, for lack of room.
std::vector<std::string> missing_texts(const pattern::Pattern& pattern, const LeftOut& left_out) {
    std::vector<std::string> lines;
    std::string seams;
    for (const Index s : left_out.seams) {
        const pattern::Seam& seam = pattern.seams[s];
        seams += (seams.empty() ? "" : "; ") + seam.label + " (" +
                 pattern.pieces[seam.sides[0].piece].name + " - " +
                 pattern.pieces[seam.sides[1].piece].name + ", " +
                 writers::number_text(seam.sides[0].length, 1) + " mm)";
    }
    if (!seams.empty())
        lines.push_back("No room for their numbers on the pieces: seams " + seams);
    std::string pieces;
    for (const Index p : left_out.pieces)
        pieces += (pieces.empty() ? "" : ", ") + pattern.pieces[p].name;
    if (!pieces.empty())
        lines.push_back("No room for their names: pieces " + pieces);
    return lines;
}

std::vector<std::string> wrapped(const std::string& text, double width) {
    std::vector<std::string> lines(1);
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t blank = text.find(' ', from);
        const std::size_t end = blank == std::string::npos ? text.size() : blank + 1;
        const std::string word = text.substr(from, end - from);
        if (!lines.back().empty() && writers::text_width(lines.back() + word, text_size) > width)
            lines.emplace_back();
        lines.back() += word;
        from = end;
    }
    return lines;
}

// Pages that are filled with lines of text from the top.
class Book {
public:
    Book(const Vec2& size, double border) : size_(size), border_(border) { begin_page(); }

    double width() const { return size_.x() - 2.0 * border_; }
    double height() const { return size_.y() - 2.0 * border_; }
    double left() const { return border_; }
    double cursor() const { return y_; }
    writers::DocumentPage& page() { return pages_.back(); }
    writers::DrawingLayer& marks() { return pages_.back().marks.front(); }

    /// Moves down, to a new page where this one has less room.
    void advance(double height) {
        if (y_ - height < border_)
            begin_page();
        y_ -= height;
    }
    void write(double x, double size, const std::string& text) {
        marks().texts.push_back(
            {Vec2(border_ + x, y_), size, text, 0.0, writers::TextAnchor::left});
    }
    std::vector<writers::DocumentPage> take() { return std::move(pages_); }

private:
    void begin_page() {
        pages_.emplace_back();
        pages_.back().width = size_.x();
        pages_.back().height = size_.y();
        pages_.back().marks.push_back({"page", "Page marks", "#000000", {}, {}, {}});
        y_ = size_.y() - border_;
    }

    Vec2 size_;
    double border_;
    double y_ = 0.0;
    std::vector<writers::DocumentPage> pages_;
};

void add_pictures(const Mesh& mesh, const pattern::Pattern& pattern, Book& book) {
    const double side = std::min(0.5 * book.width(), picture_share * book.height());
    book.advance(side + 0.5 * line_pitch);
    double x = book.left();
    for (const double azimuth : azimuths) {
        ModelView view = draw_model(mesh, pattern, azimuth, picture_pixels);
        view.image.low = Vec2(x, book.cursor());
        view.image.size = Vec2::Constant(side);
        for (const PieceLabel& label : view.labels) {
            const std::string& name = pattern.pieces[label.piece].name;
            const double room = side * label.radius / writers::text_width(name, 0.6);
            const double size = std::min(largest_label, room);
            if (size >= least_label)
                book.marks().texts.push_back({view.image.low + side * label.position, size, name});
        }
        book.page().images.push_back(std::move(view.image));
        x += 0.5 * book.width();
    }
}

void add_table(const std::vector<Row>& rows, Book& book) {
    const auto column = [&](std::size_t i) { return columns[i] * book.width(); };
    const char* const heads[] = {"Piece", "Size in mm", "Page", "Cut",
                                 "Joined pieces: seam numbers"};
    book.advance(line_pitch);
    for (std::size_t i = 0; i < 5; ++i)
        book.write(column(i), text_size, heads[i]);
    const double rule = book.cursor() - 0.5 * line_pitch;
    book.marks().paths.push_back(
        {"", {{{Vec2(book.left(), rule), Vec2(book.left() + book.width(), rule)}, false}}});
    for (const Row& row : rows) {
        std::vector<std::vector<std::string>> cells;
        std::size_t lines = 0;
        for (std::size_t i = 0; i < 5; ++i) {
            const double end = i < 4 ? column(i + 1) - text_size : book.width();
            cells.push_back(wrapped(i < 4 ? row.cells[i] : row.seams, end - column(i)));
            lines = std::max(lines, cells.back().size());
        }
        for (std::size_t line = 0; line < lines; ++line) {
            book.advance(line_pitch);
            for (std::size_t i = 0; i < 5; ++i)
                if (line < cells[i].size())
                    book.write(column(i), text_size, cells[i][line]);
        }
    }
}

} // namespace

std::vector<writers::DocumentPage> cover_pages(const Mesh& mesh, const pattern::Pattern& pattern,
                                               const PatternLayout& layout,
                                               const std::vector<PrintedPage>& pages,
                                               const std::string& title) {
    Book book(layout.page ? layout.page->size : a4,
              layout.page ? std::max(layout.page->margin, 0.5 * margin) : margin);
    book.advance(title_size);
    book.write(0.0, title_size, title);
    book.advance(1.5 * line_pitch);
    book.write(0.0, text_size,
               std::to_string(pattern.pieces.size()) + " pieces, " +
                   std::to_string(pattern.seams.size()) +
                   " seams. 1 unit of the model = " + writers::number_text(pattern.mm_per_unit, 4) +
                   " mm. Print at 100 %, without scaling.");
    add_pictures(mesh, pattern, book);
    add_table(table_rows(pattern, layout, pages), book);
    for (const std::string& text : missing_texts(pattern, layout.left_out)) {
        book.advance(0.5 * line_pitch);
        for (const std::string& line : wrapped(text, book.width())) {
            book.advance(line_pitch);
            book.write(0.0, text_size, line);
        }
    }
    return book.take();
}

} // namespace devseg::sheet
