// The yardstick of [YGZS05, table 1]: how far charts are stretched when each is mapped to a disc,
// its boundary to the circle by length and its inside conformally. It depends on the charts alone
// and not on how well a flattening method treats them.
//
// References
//   [YGZS05] H. Yamauchi, S. Gumhold, R. Zayer, H.-P. Seidel: Mesh Segmentation Driven by Gaussian
//            Curvature. The Visual Computer 21, 2005. doi:10.1007/s00371-005-0319-x
//   [DMA02]  M. Desbrun, M. Meyer, P. Alliez: Intrinsic Parameterizations of Surface Meshes.
//            Computer Graphics Forum 21(3), 2002. doi:10.1111/1467-8659.00580
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::metrics {

/// L2 stretch (Sander et al. 2001) of each chart's map to the disc, with the disc scaled so that
/// the faces have the chart's area in sum. The inside minimises the Dirichlet energy (cotangents as
/// they are: faces may turn over, which changes neither their stretch nor their area).
/// Throws NumericalFailure for charts that are no disks, and Cancelled.
std::vector<double> circle_map_stretch(const Mesh& mesh, const atlas::ChartMap& charts,
                                       Progress& progress);

} // namespace devseg::metrics
