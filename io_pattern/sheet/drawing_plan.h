// Where sheets lie in a drawing, which of their pages are printed, and how people check the scale.
#pragma once

#include <vector>

#include "sheet/sheet_drawing.h"

namespace devseg::sheet {

/// Importers that scale drawings do it unseen: a ruler on these squares shows it.
struct CheckSquare {
    const char* id;
    const char* text;
    double side; // mm
};
constexpr CheckSquare check_squares[] = {{"check-square", "50 mm", 50.0},
                                         {"check-square-inch", "2 inch", 50.8}};

/// The place of the sheets, side by side. Without pages the check squares lie in a strip beside the
/// sheet or below, whatever takes less paper; pages have their squares on them.
struct DrawingPlan {
    std::vector<Vec2> sheets;  // lower left corners
    std::vector<Vec2> squares; // of the strip
    Vec2 size = Vec2::Zero();
};
DrawingPlan plan_drawing(const PatternLayout& layout, bool scale_check);

/// A rectangle as a closed line.
writers::DrawingPolyline rectangle(const Vec2& low, const Vec2& size);

/// The layer "scale": a frame around everything, or around each page and its printable area, and
/// check squares, as the options want them. The square of a page lies where it meets no piece, or
/// across the fewest lines.
writers::DrawingLayer scale_layer(const PatternLayout& layout, const DrawingPlan& plan,
                                  const std::vector<PrintedPage>& pages,
                                  const writers::Drawing& drawing, const ExportOptions& options);

} // namespace devseg::sheet
