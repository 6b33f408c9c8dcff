// Texture coordinates at the corners of faces ("wedges"), and the charts that they imply.
#pragma once

#include <vector>

#include "devseg/mesh/charts.h"

namespace devseg {

/// Position in the plane of corner k of face f at index 3 f + k.
using CornerUv = std::vector<Vec2>; // 3 #F

/// Charts and cuts as texture coordinates show them: an edge is a seam where the coordinates on
/// its two sides differ by more than a millionth of the size of the whole layout.
ChartMap charts_from_uv(const Mesh& mesh, const CornerUv& uv);

/// Internal units for one unit of the texture coordinates: the one scale at which a layout is true.
/// Where the boundaries of all charts agree on it, as when the flattening kept their lengths, it is
/// theirs; otherwise the one that gives the layout the surface's area. 0 for a layout without area.
double layout_scale(const Mesh& mesh, const ChartMap& charts, const CornerUv& uv);

/// Signed area of face f in the plane, in squared units of `uv`.
double uv_area(const CornerUv& uv, Index f);

} // namespace devseg
