// Drawing → DXF of release 2000, which has splines.
#pragma once

#include <string>
#include <vector>

#include "writers/drawing.h"

namespace devseg::writers {

/// The file's bytes, in millimetres ($INSUNITS). Each outline with curves is one spline of degree
/// 3: the Bézier curves one after the other, straight lines among them.
std::string dxf_bytes_with_splines(const Drawing& drawing,
                                   const std::vector<const DrawingLayer*>& layers);

} // namespace devseg::writers
