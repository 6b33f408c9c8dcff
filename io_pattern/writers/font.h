// Fonts that are part of the library: for texts as outlines, and for names that the standard fonts
// of PDF cannot write. DejaVu Sans has Latin, Greek, Cyrillic, Armenian, Georgian, Hebrew, Arabic
// and many signs; what it lacks is taken from Droid Sans Fallback: Chinese, Japanese and Korean.
// Each character has a glyph of its own: letters are not joined.
//
// References
//   ISO/IEC 14496-22:2019: Open Font Format. Tables cmap (format 12), glyf, head, hhea, hmtx, loca.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "writers/drawing.h"

namespace devseg::writers {

class Font {
public:
    /// `name` of the typeface, without blanks; `bytes` of a file with outlines of TrueType.
    Font(std::string name, std::string_view bytes);

    const std::string& name() const { return name_; }
    /// Around all glyphs, in font sizes.
    const Eigen::AlignedBox2d& box() const { return box_; }
    /// Of lines, above the baseline and (below 0) under it, in font sizes.
    double ascent() const { return ascent_; }
    double descent() const { return descent_; }

    /// 0 where the font has none.
    int glyph(unsigned code_point) const;
    /// Width of the glyph with its margins, in font sizes.
    double advance(int glyph) const;
    /// Closed curves in font sizes, the start of the baseline at the origin, y up.
    std::vector<DrawingPolyline> outline(int glyph) const;

    /// A font file with the outlines of these glyphs alone, under the same numbers.
    std::string subset(const std::set<int>& glyphs) const;
    int glyph_count() const { return glyph_count_; }

private:
    struct Table {
        std::size_t start = 0;
        std::size_t size = 0;
    };

    Table table(const char* name) const;
    unsigned u16(std::size_t at) const;
    std::uint32_t u32(std::size_t at) const;
    int s16(std::size_t at) const;
    Table glyph_data(int glyph) const; // in glyf
    void add_simple(std::size_t at, int contours, std::vector<DrawingPolyline>& result) const;
    void add_parts(std::size_t at, std::vector<DrawingPolyline>& result) const;
    void add_needed(int glyph, std::set<int>& all) const;

    std::string name_;
    std::string_view bytes_;
    double units_ = 1.0; // of a font size
    Eigen::AlignedBox2d box_;
    double ascent_ = 0.0;
    double descent_ = 0.0;
    bool long_places_ = false;
    int glyph_count_ = 0;
    int metric_count_ = 0;
    Table loca_;
    Table glyf_;
    Table hmtx_;
    std::size_t groups_ = 0; // of code points, in cmap
    std::uint32_t group_count_ = 0;
};

/// All that are part of the library, in the order in which they are asked for a glyph.
const std::vector<Font>& built_in_fonts();

struct Glyph {
    std::size_t font = 0; // in built_in_fonts()
    int number = 0;       // 0: no font has one, a box is drawn
};
Glyph glyph_of(unsigned code_point);
/// In font sizes.
double advance(const Glyph& glyph);

/// Code points of valid UTF-8; stray bytes count as characters that no file can hold.
std::vector<unsigned> code_points(const std::string& utf8);

/// Whether the standard fonts of PDF cannot write the text.
bool needs_font(const std::string& utf8);

/// How many characters of the text no font has a glyph for.
int missing_glyphs(const std::string& utf8);

/// The drawing with all texts as outlines, as wide as the texts.
Drawing with_outlined_texts(Drawing drawing);

} // namespace devseg::writers
