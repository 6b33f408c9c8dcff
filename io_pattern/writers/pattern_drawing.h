// Pattern pieces → drawing: cut lines, the means to check the scale, and the pieces' names.
#pragma once

#include "devseg/pattern/pieces.h"
#include "writers/drawing.h"

namespace devseg {

/// Layers: "cut" with one path for each piece (outline first, then its holes), "scale" with the
/// frame of the sheet and a 50 mm check square beside the pieces, "text" with the pieces' names.
/// The sheet is as large as the pieces need, with a margin of 10 mm.
Drawing draw_pattern(const Pattern& pattern, const PatternOptions& options);

} // namespace devseg
