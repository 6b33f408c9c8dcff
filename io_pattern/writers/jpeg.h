// Pictures → JPEG, for files that hold photographs. By libjpeg-turbo.
#pragma once

#include <string>
#include <vector>

#include "writers/drawing.h"

namespace devseg::writers {

/// Baseline JPEG (JFIF) of full colour resolution, at a quality that prints cannot show (92 of
/// 100). Sides of 1 to 65535 pixels; others throw InvalidParameter.
std::string jpeg_bytes(const DrawingImage& image);

/// The same of each, on all cores.
std::vector<std::string> jpeg_files(const std::vector<DrawingImage>& images);

} // namespace devseg::writers
