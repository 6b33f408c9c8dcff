// Texture coordinates at the corners of faces ("wedges"), and the charts that they imply.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/plane/plane.h"

namespace devseg::atlas {

/// Charts and cuts as texture coordinates show them: an edge is a seam where the coordinates on
/// its two sides differ by more than a millionth of the size of the whole layout.
ChartMap charts_from_uv(const Mesh& mesh, const CornerUv& uv);

/// Internal units for one unit of the texture coordinates: the one scale at which a layout is true.
/// Where the boundaries of all charts agree on it, as when the flattening kept their lengths, it is
/// theirs; otherwise the one that gives the layout the surface's area. 0 for a layout without area.
double layout_scale(const Mesh& mesh, const ChartMap& charts, const CornerUv& uv);

/// Positions of a chart's vertices in the plane (#v), from the texture coordinates of its corners,
/// which agree at each vertex, times `scale` along u and v.
std::vector<Vec2> read_map(const ChartSurface& surface, const CornerUv& uv, const Vec2& scale);

} // namespace devseg::atlas
