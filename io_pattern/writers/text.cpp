// References
//   Adobe Systems: Font metrics for the PDF core 14 fonts, Helvetica.afm. 1997.
#include "writers/text.h"

#include <array>
#include <charconv>
#include <cmath>

#include "writers/font.h"

namespace devseg::writers {

namespace {

// Character widths from the blank (32) to the tilde (126), in thousandths of the font size.
constexpr std::array<int, 95> widths = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};
constexpr int other_width = 667; // accented letters are as wide as their letter, at most about this

// One byte for each character; `last` is the largest that fits.
std::string narrowed(const std::string& utf8, unsigned last) {
    std::string bytes;
    for (const unsigned point : code_points(utf8)) {
        const bool control = point < 0x20 || (point >= 0x7f && point < 0xa0);
        bytes.push_back(control ? ' ' : point > last ? '?' : static_cast<char>(point));
    }
    return bytes;
}

} // namespace

std::vector<unsigned> code_points(const std::string& utf8) {
    std::vector<unsigned> points;
    for (std::size_t i = 0; i < utf8.size();) {
        const auto lead = static_cast<unsigned char>(utf8[i++]);
        const int follow = lead < 0x80 ? 0 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
        unsigned point = follow == 0 ? lead : lead & (0x3fu >> follow);
        for (int k = 0; k < follow && i < utf8.size(); ++k)
            point = point << 6 | (static_cast<unsigned char>(utf8[i++]) & 0x3fu);
        points.push_back(point);
    }
    return points;
}

std::string number_text(double value, int decimals) {
    char digits[400]; // the largest double has 309 digits
    const auto end =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals);
    std::string text(digits, end.ptr);
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.')
            text.pop_back();
    }
    return text == "-0" ? "0" : text;
}

double text_width(const std::string& text, double size) {
    double width = 0.0;
    const bool in_font = needs_font(text);
    for (const unsigned point : code_points(text))
        width += in_font                      ? advance(glyph_of(point))
                 : point >= 32 && point < 127 ? 1e-3 * widths[point - 32]
                                              : 1e-3 * other_width;
    return width * size;
}

Vec2 text_baseline(const DrawingText& text) {
    const double drop = 0.5 * capital_height * text.size;
    return text.position + drop * Vec2(std::sin(text.angle), -std::cos(text.angle));
}

Vec2 text_start(const DrawingText& text) {
    if (text.anchor == TextAnchor::left)
        return text_baseline(text);
    const double back = 0.5 * text_width(text.text, text.size);
    return text_baseline(text) - back * Vec2(std::cos(text.angle), std::sin(text.angle));
}

std::string latin1(const std::string& utf8) {
    return narrowed(utf8, 0xff);
}

std::string ascii(const std::string& utf8) {
    return narrowed(utf8, 0x7e);
}

} // namespace devseg::writers
