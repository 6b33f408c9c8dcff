// Patches that are too small to be pieces of cloth.
#pragma once

#include "devseg/methods/plush/seam_paths.h"
#include "devseg/methods/plush/seam_removal.h"

namespace devseg::plush {

/// Joins patches up to a share of the surface to a neighbour along all of their common border,
/// where darts up to half as long again as that border are enough to keep the limits. `cost`: of
/// paths for darts, 3 #F. Returns how many joins were tried.
Index absorb_remnants(const SeamSetting& setting, const VertexGraph& graph,
                      const std::vector<double>& cost, const PatchLimits& limits, double most_area,
                      SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
