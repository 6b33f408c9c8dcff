// Document → PDF 1.6 with layers (optional content) and one of the standard fonts.
#pragma once

#include <string>

#include "writers/drawing.h"

namespace devseg::writers {

/// The file's bytes. One millimetre is 72 / 25.4 points, and readers are told not to scale when
/// they print. The drawing is stored once and shown through the windows of the pages; layers of
/// the drawing and marks of the pages can be switched on and off one by one. All numbers must be
/// finite, and there must be a page.
std::string pdf_bytes(const Document& document);

} // namespace devseg::writers
