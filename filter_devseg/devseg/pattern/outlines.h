// The outlines of charts in the plane of their texture coordinates, as pieces on paper.
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// One piece for each chart, without name and label, where the texture coordinates put it up to a
/// common shift. `uv_areas` are the charts' signed areas: charts with 0 are left out, and negative
/// ones are turned over. A layout that is mirrored for the most part is mirrored as a whole; other
/// mirrored charts keep their place, or go to rows above the layout where they would touch others.
std::vector<PatternPiece> trace_pieces(const Mesh& mesh, const CornerUv& uv,
                                       const atlas::ChartMap& charts,
                                       const std::vector<double>& uv_areas, double mm_per_uv,
                                       Progress& progress);

/// Sets the areas of the outlines and of the piece, and its box.
void measure_outlines(PatternPiece& piece);

} // namespace devseg::pattern
