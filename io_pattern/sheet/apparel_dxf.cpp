// References
//   ASTM D6673-10: Standard practice for sewn products pattern data interchange, data format.
//   American Apparel Manufacturers Association: ANSI/AAMA-292-B, 1993.
#include "sheet/apparel_dxf.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "writers/dxf_text.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

constexpr double apparel_text = 4.0;  // mm
constexpr double apparel_pitch = 6.0; // mm
constexpr int decimals = 4;

// Block and style names: capital letters, digits, underscores and hyphens.
std::string code(const std::string& text) {
    std::string name;
    for (const char c : writers::ascii(text)) {
        const auto byte = static_cast<unsigned char>(c);
        name += std::isalnum(byte) != 0 || c == '-' ? static_cast<char>(std::toupper(byte)) : '_';
    }
    return name;
}

double corner_cosine(const ExportOptions& options) {
    return std::cos(options.corner_angle / writers::degrees_per_radian);
}

void write_point(writers::DxfText& file, const char* layer, const Vec2& p) {
    file.group(0, "POINT");
    file.group(8, layer);
    file.point(p);
}

// Corners are turn points, all others lie on curves.
void write_outline_points(writers::DxfText& file, const std::vector<Vec2>& ring,
                          double smooth_cosine) {
    const std::size_t count = ring.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 in = ring[i] - ring[(i + count - 1) % count];
        const Vec2 out = ring[(i + 1) % count] - ring[i];
        const bool smooth = in.dot(out) >= smooth_cosine * in.norm() * out.norm();
        write_point(file, smooth ? "3" : "2", ring[i]);
    }
}

void write_notch(writers::DxfText& file, const SheetNotch& notch) {
    const Vec2 d = notch.inner - notch.outer;
    write_point(file, "4", notch.outer);
    file.number(30, d.norm()); // depth
    file.number(39, 0.0);      // width of a slit
    file.number(50, std::atan2(d.y(), d.x()) * writers::degrees_per_radian);
}

void write_texts(writers::DxfText& file, const char* layer, Vec2 place,
                 const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
        file.text(layer, {place, apparel_text, line, 0.0, writers::TextAnchor::left});
        place.y() -= apparel_pitch;
    }
}

// Pieces of one shape are counted on the first of them, as they are and mirrored; the others keep
// their outlines, notches and seams, and count nothing.
std::string quantity(const pattern::PatternPiece& piece) {
    if (piece.model < 0)
        return "1,0";
    return std::to_string(piece.quantity) + ',' + std::to_string(piece.mirrored_quantity);
}

std::string annotation(const pattern::PatternPiece& piece, const pattern::Pattern& pattern) {
    if (piece.model >= 0 && piece.quantity == 0)
        return (piece.mirrored ? "MIRROR OF " : "SAME AS ") + pattern.pieces[piece.model].name +
               ", COUNTED THERE";
    std::string text = "CUT " + std::to_string(std::max(Index{1}, piece.quantity));
    if (piece.mirrored_quantity > 0)
        text += " + " + std::to_string(piece.mirrored_quantity) + " MIRRORED";
    return text;
}

void write_lines(writers::DxfText& file, const char* layer,
                 const std::vector<std::vector<Vec2>>& lines, bool closed) {
    for (const std::vector<Vec2>& line : lines)
        file.polyline(layer, {line, closed});
}

void write_block(writers::DxfText& file, const pattern::Pattern& pattern, const SheetPiece& piece,
                 const ExportOptions& options) {
    const pattern::PatternPiece& source = pattern.pieces[piece.piece];
    file.group(0, "BLOCK");
    file.group(8, "1");
    file.group(2, code(piece.name));
    file.group(70, "64");
    file.point(Vec2::Zero());
    file.polyline("1", {piece.cut.front(), true});
    write_outline_points(file, piece.cut.front(), corner_cosine(options));
    write_lines(file, "11", {piece.cut.begin() + 1, piece.cut.end()}, true);
    write_lines(file, piece.has_allowance() ? "14" : "11", piece.slits, false);
    write_lines(file, "14", piece.sew, true);
    write_lines(file, "8", piece.mountains, false);
    write_lines(file, "8", piece.valleys, false);
    for (const SheetNotch& notch : piece.notches)
        write_notch(file, notch);
    for (std::size_t i = 0; i + 1 < piece.drills.size(); i += 2) { // crosses have two lines
        file.group(0, "POINT");
        file.group(8, "13");
        file.point(0.5 * (piece.drills[i].front() + piece.drills[i].back()));
    }
    if (piece.grain_line[0] != piece.grain_line[1])
        file.line("7", piece.grain_line[0], piece.grain_line[1]);
    std::vector<std::string> seams;
    for (const Index s : source.seams()) {
        const pattern::Seam& seam = pattern.seams[at(s)];
        for (const int side : {0, 1})
            if (seam.sides[side].piece == piece.piece)
                seams.push_back("SEAM: " + seam.label + " TO " +
                                pattern.pieces[seam.sides[1 - side].piece].name);
    }
    const Vec2 place = piece.names.empty() ? piece.box().center() : piece.names.front().position;
    write_texts(file, "15", place, seams);
    write_texts(file, "1", place + Vec2(0.0, 6.0 * apparel_pitch),
                {"Piece Name: " + piece.name, "Size: M", "Quantity: " + quantity(source),
                 "Annotation: " + annotation(source, pattern), "Category: PATTERN",
                 "Fabric: " + (pattern.material ? code(pattern.material->name) : "MAIN")});
    file.group(0, "ENDBLK");
    file.group(8, "1");
}

} // namespace

std::string apparel_dxf_bytes(const pattern::Pattern& pattern, const PatternLayout& layout,
                              const ExportOptions& options, const ApparelHeader& header) {
    std::vector<pack::Placement> shifts(layout.sheets.size());
    for (std::size_t s = 1; s < shifts.size(); ++s)
        shifts[s].offset.x() = shifts[s - 1].offset.x() + layout.sheets[s - 1].size.x() + sheet_gap;
    writers::DxfText file(decimals);
    file.begin_section("HEADER");
    file.end_section();
    file.begin_section("BLOCKS");
    for (SheetPiece piece : layout.pieces) {
        piece.move(shifts[piece.sheet]);
        write_block(file, pattern, piece, options);
    }
    file.end_section();
    file.begin_section("ENTITIES");
    for (const SheetPiece& piece : layout.pieces) {
        file.group(0, "INSERT");
        file.group(8, "1");
        file.group(2, code(piece.name));
        file.point(Vec2::Zero());
    }
    write_texts(file, "1", Vec2(0.0, -apparel_pitch),
                {"Style Name: " + code(header.style), "Creation Date: " + header.date,
                 "Author: DEVSEG", "Sample Size: M", "Grading Rule Table: NONE", "Units: METRIC",
                 "ASTM/D13Proposal 1 Version: D 6673-04"});
    file.end_section();
    return file.file();
}

} // namespace devseg::sheet
