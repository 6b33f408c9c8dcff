// Documents → pictures of their pages.
#pragma once

#include <string>
#include <vector>

#include "writers/drawing.h"

namespace devseg::writers {

/// The bytes of a PNG file for each page, with its size: 300 pixels for an inch, rounded up. Lines
/// are as wide as in PDF files, and letters are outlines of the built-in font. Throws
/// InvalidParameter for pages that have more than `most_pixels` pixels.
std::vector<std::string> png_pages(const Document& document);

constexpr double most_pixels = 2.5e8;

/// An image as a PNG file that prints at its size.
std::string png_bytes(const DrawingImage& image);

} // namespace devseg::writers
