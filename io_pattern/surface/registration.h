// Marks that a cutter finds the print by.
#pragma once

#include "sheet/layout.h"
#include "writers/drawing.h"

namespace devseg::surface {

/// The layer "registration" with marks in the four corners of a sheet, within its margin: a circle
/// with a cross, and a second circle at the lower left, so that nobody turns the sheet over. Throws
/// InvalidParameter for margins without room.
writers::DrawingLayer registration_marks(const std::vector<writers::DrawingSheet>& sheets,
                                         double margin);

/// The same for a drawing of the layout: one set on each of its pages, or on its sheet.
writers::DrawingLayer registration_marks(const sheet::PatternLayout& layout,
                                         const writers::Drawing& drawing, const Vec2& sheet_low);

} // namespace devseg::surface
