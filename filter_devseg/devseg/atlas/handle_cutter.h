// Short loops through the handles of a chart.
//
// References
//   [YGZS05] H. Yamauchi, S. Gumhold, R. Zayer, H.-P. Seidel: Mesh Segmentation Driven by Gaussian
//            Curvature. The Visual Computer 21, 2005, section 3.6. doi:10.1007/s00371-005-0319-x
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::atlas {

/// Half-edges (local, one for each edge) of one loop for each handle: cut open along them, the
/// chart has no handle left, and hangs together. A region grows from one face and keeps its
/// wavefronts short. Where two wavefronts meet there is a handle, cut along the shorter of the
/// shortest loops that the two have been. Parts of loops on the chart's boundary cost nothing.
std::vector<Index> cut_handles(const Mesh& mesh, const ChartSurface& surface,
                               const Progress& progress);

} // namespace devseg::atlas
