// Pictures → JPEG, for files that hold photographs.
#pragma once

#include <string>

#include "writers/drawing.h"

namespace devseg::writers {

/// Baseline JPEG (JFIF) of full colour resolution, at a quality that prints cannot show (92 of
/// 100). Sides of 1 to 65535 pixels; others throw InvalidParameter.
std::string jpeg_bytes(const DrawingImage& image);

} // namespace devseg::writers
