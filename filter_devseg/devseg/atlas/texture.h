// Texture coordinates at the corners of faces ("wedges"), and the charts that they imply.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/plane/plane.h"

namespace devseg::atlas {

/// Charts and cuts as texture coordinates show them: an edge is a seam where the coordinates on
/// its two sides differ by more than `tolerance`, a share of the size of the whole layout: writers
/// of texture coordinates round to 6 digits, and smaller differences are no seams. It is one as
/// well where its two faces lie on the same side of it, as where one half of a model is the mirror
/// image of the other in the texture; but faces that are turned over here and there, less than a
/// twentieth of their chart, are flaws of the chart.
ChartMap charts_from_uv(const Mesh& mesh, const CornerUv& uv, double tolerance = 1e-6);

/// A layout that is true at one scale.
struct EvenLayout {
    CornerUv uv;        // 3 #F
    double scale = 0.0; // internal units for one unit of `uv`; 0 for a layout without area
    bool is_as_given = true;
};

/// The one scale at which a layout is true. Where the boundaries of all charts agree on it, as when
/// the flattening kept their lengths, it is theirs; otherwise the one that gives the layout the
/// surface's area. If neither the area nor the boundary of some chart is true there, as atlases for
/// painting have islands at different scales, every chart is brought to that of its own area, about
/// its middle: charts may then lie on each other.
EvenLayout even_layout(const Mesh& mesh, const ChartMap& charts, const CornerUv& uv);

/// Positions of a chart's vertices in the plane (#v), from the texture coordinates of its corners,
/// which agree at each vertex, times `scale` along u and v.
std::vector<Vec2> read_map(const ChartSurface& surface, const CornerUv& uv, const Vec2& scale);

} // namespace devseg::atlas
