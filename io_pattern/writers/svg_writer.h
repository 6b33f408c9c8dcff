// Drawing → SVG 1.1 with Inkscape's layers and pages.
#pragma once

#include <string>

#include "writers/drawing.h"

namespace devseg::writers {

/// The file's bytes (UTF-8): 1 user unit is 1 mm. The same drawing gives the same bytes, whatever
/// the locale. All numbers of the drawing must be finite.
std::string svg_bytes(const Drawing& drawing);

} // namespace devseg::writers
