// Numbers and texts in files: fixed notation that knows no locale, and how much room text takes by
// the metrics of Helvetica, which every PDF reader knows and the fonts of other readers resemble.
#pragma once

#include <string>
#include <vector>

#include "writers/drawing.h"

namespace devseg::writers {

/// At most `decimals` digits behind the point, no trailing zeros, no sign of −0. Finite numbers.
std::string number_text(double value, int decimals);

/// What `text` makes of the points, without those that read as the one before (in a closed line,
/// the last one comes before the first): cutters stop at each point.
template <class Text>
std::vector<std::string> point_texts(const DrawingPolyline& line, Text text) {
    std::vector<std::string> texts;
    for (const Vec2& p : line.points) {
        std::string next = text(p);
        if (texts.empty() || next != texts.back())
            texts.push_back(std::move(next));
    }
    if (line.closed && texts.size() > 1 && texts.back() == texts.front())
        texts.pop_back();
    return texts;
}

constexpr double degrees_per_radian = 180.0 / pi;
constexpr double capital_height = 0.72; // of the font size

/// Width in mm of UTF-8 text at a font size in mm.
double text_width(const std::string& text, double size);

/// Where the baseline starts, or has its middle: what file formats call the place of a text.
Vec2 text_baseline(const DrawingText& text);

/// The same for the left end of the baseline, whatever the anchor.
Vec2 text_start(const DrawingText& text);

/// UTF-8 → Latin-1; characters beyond it become '?', control characters blanks.
std::string latin1(const std::string& utf8);

/// Only characters that 7-bit files can hold; others become '?', control characters blanks.
std::string ascii(const std::string& utf8);

} // namespace devseg::writers
