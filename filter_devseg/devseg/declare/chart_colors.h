// One colour for each chart, neighbours clearly different.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::declare {

/// Colours of the charts (#charts). The largest charts choose first, each the palette's first
/// colour that no neighbour has: the same charts get the same colours, whatever their numbers.
std::vector<Color> chart_colors(const Mesh& mesh, const atlas::ChartMap& charts);

/// The same, spread to the faces (#F).
std::vector<Color> face_chart_colors(const Mesh& mesh, const atlas::ChartMap& charts);

} // namespace devseg::declare
