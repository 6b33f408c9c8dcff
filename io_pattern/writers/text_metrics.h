// How much room text takes: the metrics of Helvetica, which every PDF reader knows and the fonts
// of other readers resemble.
#pragma once

#include <string>

#include "writers/drawing.h"

namespace devseg::writers {

constexpr double degrees_per_radian = 180.0 / pi;

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
