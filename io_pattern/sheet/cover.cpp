#include "sheet/cover.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/plane/plane.h"
#include "sheet/cloth_texts.h"
#include "sheet/needs.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

struct PieceLabel {
    Index piece = -1;
    Vec2 position = Vec2::Zero(); // in the unit square of the picture, y up
    double radius = 0.0;          // distance from the piece's border in the picture, same units
};

struct ModelView {
    writers::DrawingImage image;    // square; place and size are the caller's
    std::vector<PieceLabel> labels; // where the pieces that can be seen are best seen
};

constexpr int picture_samples = 2; // pixels in each direction that are averaged
constexpr double elevation = 0.32; // radians
constexpr double frame = 0.03;     // of the picture's side that stays empty on each side
constexpr double ambient = 0.55;
constexpr double line_shade = 0.25;
const Vec3 light(-0.45, 0.65, 0.61);

// What is seen at each pixel: the face nearest to the eye.
class DepthBuffer {
public:
    explicit DepthBuffer(int side)
        : side_(side), face_(at(side) * at(side), -1),
          depth_(face_.size(), std::numeric_limits<double>::lowest()) {}

    /// Corners in pixels, y down; z towards the eye.
    void draw(const std::array<Vec3, 3>& p, Index face) {
        const double area = cross(p[0], p[1], p[2]);
        if (area == 0.0)
            return;
        const auto clamped = [&](double v) {
            return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(side_ - 1)));
        };
        const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
        const auto [top, bottom] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
        for (int y = clamped(top); y <= clamped(bottom); ++y)
            for (int x = clamped(left); x <= clamped(right); ++x) {
                const Vec3 centre(x + 0.5, y + 0.5, 0.0);
                const double a = cross(p[1], p[2], centre) / area;
                const double b = cross(p[2], p[0], centre) / area;
                const double c = 1.0 - a - b;
                if (a < 0.0 || b < 0.0 || c < 0.0)
                    continue;
                const double z = a * p[0].z() + b * p[1].z() + c * p[2].z();
                const std::size_t i = index(x, y);
                if (z > depth_[i]) {
                    depth_[i] = z;
                    face_[i] = face;
                }
            }
    }

    Index face(int x, int y) const {
        return x >= 0 && y >= 0 && x < side_ && y < side_ ? face_[index(x, y)] : -1;
    }

private:
    static double cross(const Vec3& a, const Vec3& b, const Vec3& c) {
        return plane::cross((b - a).head<2>(), (c - a).head<2>());
    }
    std::size_t index(int x, int y) const { return at(y) * at(side_) + at(x); }

    int side_;
    std::vector<Index> face_;
    std::vector<double> depth_;
};

// Rows are right, up and towards the eye.
Eigen::Matrix3d view_rotation(double azimuth) {
    const Vec3 back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                    std::cos(azimuth) * std::cos(elevation));
    const Vec3 right(std::cos(azimuth), 0.0, -std::sin(azimuth));
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), back.cross(right).transpose(), back.transpose();
    return rotation;
}

DepthBuffer project(const Mesh& mesh, const Eigen::Matrix3d& rotation, int side) {
    Eigen::AlignedBox3d box;
    std::vector<Vec3> seen;
    for (const Vec3& p : mesh.points) {
        seen.push_back(rotation * p);
        box.extend(seen.back());
    }
    const double extent = std::max(box.sizes().x(), box.sizes().y());
    const double scale = (1.0 - 2.0 * frame) * side / extent;
    DepthBuffer buffer(side);
    for (Vec3& p : seen) {
        const Vec3 q = scale * (p - box.center());
        p = Vec3(q.x() + 0.5 * side, 0.5 * side - q.y(), q.z());
    }
    for (const Face f : mesh.all_faces()) {
        const Triangle& t = mesh.faces[f];
        buffer.draw({seen[t[0]], seen[t[1]], seen[t[2]]}, f);
    }
    return buffer;
}

// For each piece the pixel that is farthest from others, in city blocks.
std::vector<PieceLabel> find_labels(const std::vector<Index>& piece_of_pixel, int side,
                                    std::size_t pieces) {
    std::vector<int> depth(piece_of_pixel.size(), 0);
    const auto at_pixel = [&](int x, int y) { return at(y) * at(side) + at(x); };
    const auto reach = [&](int x, int y, int dx, int dy) {
        const int u = x + dx;
        const int v = y + dy;
        const bool outside = u < 0 || v < 0 || u >= side || v >= side;
        return outside || piece_of_pixel[at_pixel(u, v)] != piece_of_pixel[at_pixel(x, y)]
                   ? 1
                   : 1 + depth[at_pixel(u, v)];
    };
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            depth[at_pixel(x, y)] = std::min(reach(x, y, -1, 0), reach(x, y, 0, -1));
    std::vector<PieceLabel> best(pieces);
    for (int y = side - 1; y >= 0; --y)
        for (int x = side - 1; x >= 0; --x) {
            const std::size_t i = at_pixel(x, y);
            depth[i] = std::min({depth[i], reach(x, y, 1, 0), reach(x, y, 0, 1)});
            const Index piece = piece_of_pixel[i];
            const double radius = static_cast<double>(depth[i]) / side;
            if (piece >= 0 && radius > best[piece].radius)
                best[piece] = {piece, Vec2(x + 0.5, side - y - 0.5) / side, radius};
        }
    best.erase(std::remove_if(best.begin(), best.end(),
                              [](const PieceLabel& label) { return label.piece < 0; }),
               best.end());
    return best;
}

// Parallel projection from `azimuth` (radians about y, 0 = from the front, along −z) and a little
// above; a colour for each piece, dark lines along the seams.
ModelView draw_model(const Mesh& mesh, const pattern::Pattern& pattern, double azimuth,
                     int pixels) {
    const int side = pixels * picture_samples;
    const Eigen::Matrix3d rotation = view_rotation(azimuth);
    const DepthBuffer buffer = project(mesh, rotation, side);
    const std::vector<declare::Color> colors = piece_colors(pattern);
    const auto piece_at = [&](int x, int y) {
        const Index f = buffer.face(x, y);
        return f < 0 ? Index{-2} : pattern.face_piece[f];
    };
    ModelView view;
    view.image.columns = view.image.rows = pixels;
    std::vector<int> sums(3 * at(pixels) * at(pixels), 0);
    std::vector<Index> pieces;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const Index piece = piece_at(x, y);
            pieces.push_back(std::max(piece, Index{-1}));
            const bool border = piece != piece_at(x + 1, y) || piece != piece_at(x, y + 1) ||
                                piece != piece_at(x - 1, y) || piece != piece_at(x, y - 1);
            double shade = 1.0;
            declare::Color color{255, 255, 255};
            if (piece > -2) {
                const Vec3 normal = rotation * mesh.face_normals[buffer.face(x, y)];
                shade = ambient + (1.0 - ambient) * std::abs(normal.dot(light));
                color = piece >= 0 ? colors[piece] : colors.back();
            }
            if (border)
                shade *= line_shade;
            for (std::size_t k = 0; k < 3; ++k)
                sums[3 * (at(y / picture_samples) * at(pixels) + at(x / picture_samples)) + k] +=
                    static_cast<int>(std::lround(shade * color[k]));
        }
    for (const int sum : sums)
        view.image.rgb.push_back(
            static_cast<std::uint8_t>(std::min(255, sum / (picture_samples * picture_samples))));
    view.labels = find_labels(pieces, side, pattern.pieces.size());
    return view;
}

const Vec2 a4(210.0, 297.0);
constexpr double cover_title = 7.0; // mm
constexpr double cover_text = 3.2;
constexpr double cover_pitch = 4.6;
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

// The notes as sentences.
std::vector<std::string> note_texts(const pattern::Pattern& pattern, const PatternLayout& layout) {
    std::vector<std::string> lines = pattern.notes;
    if (layout.seams_without_tab > 0)
        lines.push_back(layout_notes(pattern, layout).front());
    for (std::string& line : lines)
        line = "Note: " + line + '.';
    for (std::string& line : missing_texts(pattern, layout.left_out))
        lines.push_back(std::move(line));
    return lines;
}

std::vector<std::string> wrapped(const std::string& text, double width) {
    std::vector<std::string> lines(1);
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t blank = text.find(' ', from);
        const std::size_t end = blank == std::string::npos ? text.size() : blank + 1;
        const std::string word = text.substr(from, end - from);
        if (!lines.back().empty() && writers::text_width(lines.back() + word, cover_text) > width)
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
    book.advance(side + 0.5 * cover_pitch);
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
    book.advance(cover_pitch);
    for (std::size_t i = 0; i < 5; ++i)
        book.write(column(i), cover_text, heads[i]);
    const double rule = book.cursor() - 0.5 * cover_pitch;
    book.marks().paths.push_back(
        {"", {{{Vec2(book.left(), rule), Vec2(book.left() + book.width(), rule)}, false}}});
    for (const Row& row : rows) {
        std::vector<std::vector<std::string>> cells;
        std::size_t lines = 0;
        for (std::size_t i = 0; i < 5; ++i) {
            const double end = i < 4 ? column(i + 1) - cover_text : book.width();
            cells.push_back(wrapped(i < 4 ? row.cells[i] : row.seams, end - column(i)));
            lines = std::max(lines, cells.back().size());
        }
        for (std::size_t line = 0; line < lines; ++line) {
            book.advance(cover_pitch);
            for (std::size_t i = 0; i < 5; ++i)
                if (line < cells[i].size())
                    book.write(column(i), cover_text, cells[i][line]);
        }
    }
}

void add_paragraph(const std::string& text, double indent, Book& book) {
    for (const std::string& line : wrapped(text, book.width() - indent)) {
        book.advance(cover_pitch);
        book.write(indent, cover_text, line);
    }
}

// What is needed, and the steps.
void add_guide(const pattern::Pattern& pattern, const PatternLayout& layout,
               const std::vector<PrintedPage>& pages, const ExportOptions& options, Book& book) {
    book.advance(0.5 * cover_pitch);
    add_paragraph("What you need", 0.0, book);
    const Needs needs = find_needs(pattern, layout, options, static_cast<Index>(pages.size()));
    for (const auto& [name, value] : needs_texts(pattern, needs, options))
        add_paragraph(name + ": " + value, 2.0 * cover_text, book);
    book.advance(0.5 * cover_pitch);
    add_paragraph("Steps", 0.0, book);
    for (const std::string& text : opening_texts(pattern, layout))
        add_paragraph(text, 2.0 * cover_text, book);
    for (std::size_t k = 0; k < layout.assembly.steps.size(); ++k)
        add_paragraph(std::to_string(k + 1) + ". " + step_text(pattern, layout, options, k),
                      2.0 * cover_text, book);
}

} // namespace

std::vector<writers::DocumentPage> cover_pages(const pattern::Pattern& pattern,
                                               const PatternLayout& layout,
                                               const std::vector<PrintedPage>& pages,
                                               const ExportOptions& options,
                                               const std::string& title) {
    Book book(layout.page ? layout.page->size : a4,
              layout.page ? std::max(layout.page->margin, 0.5 * sheet_margin) : sheet_margin);
    book.advance(cover_title);
    book.write(0.0, cover_title, title);
    book.advance(1.5 * cover_pitch);
    book.write(0.0, cover_text,
               std::to_string(pattern.pieces.size()) + " pieces, " +
                   std::to_string(pattern.seams.size()) +
                   " seams. 1 unit of the model = " + writers::number_text(pattern.mm_per_unit, 4) +
                   " mm. Print at 100 %, without scaling.");
    add_pictures(pattern.mesh, pattern, book);
    add_table(table_rows(pattern, layout, pages), book);
    add_guide(pattern, layout, pages, options, book);
    for (const std::string& text : cloth_texts(pattern))
        add_paragraph(text, 0.0, book);
    for (const std::string& text : note_texts(pattern, layout)) {
        book.advance(0.5 * cover_pitch);
        add_paragraph(text, 0.0, book);
    }
    return book.take();
}

} // namespace devseg::sheet
