// Cuts inside charts in other places: a chain of seam edges is closed, and the shortest path opens
// between what it held together, so that the chart stays a disk.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/methods/dcharts/seam_chains.h"

namespace devseg::dcharts {

/// Half-edges of the shortest path inside the chart between the two parts into which its seams fall
/// without the chain, which has the chart on both sides. None where they do not fall apart, or
/// where no path is shorter. Cuts through flat regions count as in atlas/border_path.h.
std::vector<Index> shorter_cut(const Mesh& mesh, const Draft& draft, const Closing& chain,
                               const Progress& progress);

} // namespace devseg::dcharts
