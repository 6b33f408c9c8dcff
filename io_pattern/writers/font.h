// A font that is part of the library: for texts as outlines, and for names that the standard fonts
// of PDF cannot write. DejaVu Sans: Latin, Greek, Cyrillic, Armenian, Georgian, Hebrew, Arabic and
// many signs; no Chinese, Japanese or Korean.
//
// References
//   ISO/IEC 14496-22:2019: Open Font Format. Tables cmap (format 12), glyf, head, hhea, hmtx, loca.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "writers/drawing.h"

namespace devseg::writers {

class Font {
public:
    static const Font& built_in();

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
    explicit Font(std::string bytes);

    Table table(const char* name) const;
    unsigned u16(std::size_t at) const;
    std::uint32_t u32(std::size_t at) const;
    int s16(std::size_t at) const;
    Table glyph_data(int glyph) const; // in glyf
    void add_simple(std::size_t at, int contours, std::vector<DrawingPolyline>& result) const;
    void add_parts(std::size_t at, std::vector<DrawingPolyline>& result) const;
    void add_needed(int glyph, std::set<int>& all) const;

    std::string bytes_;
    double units_ = 1.0; // of a font size
    bool long_places_ = false;
    int glyph_count_ = 0;
    int metric_count_ = 0;
    Table loca_;
    Table glyf_;
    Table hmtx_;
    std::size_t groups_ = 0; // of code points, in cmap
    std::uint32_t group_count_ = 0;
};

/// Code points of valid UTF-8; stray bytes count as characters that no file can hold.
std::vector<unsigned> code_points(const std::string& utf8);

/// Whether the standard fonts of PDF cannot write the text.
bool needs_font(const std::string& utf8);

/// How many characters of the text the font has no glyph for.
int missing_glyphs(const std::string& utf8);

/// The drawing with all texts as outlines, as wide as the texts.
Drawing with_outlined_texts(Drawing drawing);

} // namespace devseg::writers
