// Drawing → DXF for laser cutters, plotters and drawing programs.
#pragma once

#include <string>

#include "writers/drawing.h"

namespace devseg::writers {

/// The file's bytes, 7-bit: one drawing unit is 1 mm; a DXF layer with a colour of its own for
/// each layer. Release 12, which every program reads, or 2000 where there are curves, which are
/// splines then. All numbers of the drawing must be finite.
std::string dxf_bytes(const Drawing& drawing);

} // namespace devseg::writers
