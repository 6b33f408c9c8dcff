// Pieces on their sheets → drawing: one layer for each operation.
#pragma once

#include "sheet/layout.h"
#include "writers/drawing.h"

namespace devseg::sheet {

/// Layers: "cut" (one path for each piece, outline and holes; slits are paths of their own),
/// "mountain", "valley", "sew", "notch", "grain", "numbers" and "text" as the options want them;
/// "scale" with the frames of the sheets and check squares of 50 mm and 2 inches. A laser gets
/// "cut", "engrave" and "scale". Sheets lie side by side.
writers::Drawing draw_sheets(const PatternLayout& layout, const ExportOptions& options);

} // namespace devseg::sheet
