// Joining neighbouring charts where a trial flattening allows it [JKS05, section 3.3].
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include <limits>

#include "devseg/methods/dcharts/draft.h"

namespace devseg::dcharts {

struct MergeOptions {
    StretchBounds chart;          // of each joined chart
    double max_excess = infinite; // of the draft, see Draft::excess
    // Least length of border that a join saves, over the root of the smaller chart's area: charts
    // that touch along a short border would hang together by a narrow neck.
    double least_neck = 0.5;
    double small_share = 0.01; // of the surface: smaller charts are joined to a neighbour anyway
};

/// Joins two charts at a time, those first whose common border is long and whose joined map costs
/// little stretch; neighbours are tried again after each. Returns the number of joins.
Index merge_charts(const Mesh& mesh, const MergeOptions& options, Draft& draft, Progress& progress);

} // namespace devseg::dcharts
