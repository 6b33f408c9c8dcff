// Tips: ends of closed tubes, which no flattening maps well unless they are cut open.
//
// References
//   [YGZS05] H. Yamauchi, S. Gumhold, R. Zayer, H.-P. Seidel: Mesh Segmentation Driven by Gaussian
//            Curvature. The Visual Computer 21, 2005, section 3.6. doi:10.1007/s00371-005-0319-x
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::atlas {

/// A tip is the vertex farthest from the boundary, if it is at least as far away as the boundary is
/// long [YGZS05], or the farthest one of a horn: a part of the chart that a loop of equal distance
/// encloses. A horn is at least half as high as its loop is long, so that a conformal map shrinks
/// its tip by exp(π) and more; its loop is at most this share of the boundary.
struct TipRule {
    double horn_loop = 0.5; // 0: no horns, only the rule of [YGZS05]; 1: horns as wide as the chart
};

/// The tips, ascending. `distance` (#v) is that from the boundary along edges.
std::vector<Index> find_tips(const Mesh& mesh, const ChartSurface& surface,
                             const std::vector<double>& distance, const TipRule& rule,
                             const Progress& progress);

} // namespace devseg::atlas
