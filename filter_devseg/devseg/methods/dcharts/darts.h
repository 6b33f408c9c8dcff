// Darts: cuts from a chart's border to where its map is stretched most [JKS05, section 3.3].
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include "devseg/methods/dcharts/draft.h"

namespace devseg::dcharts {

struct DartOptions {
    StretchBounds chart; // darts are cut while a chart is above them
    double worth = 1e-3; // least drop of Σ A (l2² − 1), as a share of the surface's area, for
                         // each √area of length, for a dart that does not lower the worst spot
    int max_per_chart = 12; // darts
};

/// Cuts darts into the charts that exceed the bounds, each along a short path from the border, or
/// from another dart, to the spot where that helps most; stops where no dart is worth its length.
/// Returns the number of darts.
Index cut_darts(const Mesh& mesh, const DartOptions& options, Draft& draft, Progress& progress);

/// Cuts from each of the vertices, in order, to the border of its chart or to an earlier cut; a
/// vertex on a border needs none. `seam` is 3 #F. Returns the number of cuts.
Index cut_darts_to(const Mesh& mesh, const std::vector<Index>& chart,
                   const std::vector<Index>& tips, std::vector<std::uint8_t>& seam);

} // namespace devseg::dcharts
