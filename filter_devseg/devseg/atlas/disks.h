// Cutting charts open until each is a disk, or a disk with holes that lie flat with it.
//
// References
//   [EHP04] J. Erickson, S. Har-Peled: Optimally Cutting a Surface into a Disk. Discrete &
//           Computational Geometry 31, 2004. doi:10.1007/s00454-003-2948-z (the greedy tree–cotree
//           construction, once all boundary loops are joined)
//   [YGZS05] H. Yamauchi, S. Gumhold, R. Zayer, H.-P. Seidel: Mesh Segmentation Driven by Gaussian
//           Curvature. The Visual Computer 21, 2005, section 3.6. doi:10.1007/s00371-005-0319-x
//           (loops through handles first, then joining; tips)
#pragma once

#include "devseg/atlas/charts.h"
#include "devseg/atlas/holes.h"
#include "devseg/atlas/tips.h"
#include "devseg/base/progress.h"

namespace devseg::atlas {

struct DiskOptions {
    bool cut_tips = true; // cut up to tips as well
    TipRule tip_rule;     // what counts as a tip
    HoleRule holes = {};  // which holes get no slit
};

struct DiskCuts {
    ChartMap charts;         // the same charts with more seams
    Index cut_charts = 0;    // charts that had to be cut
    Index cut_tips = 0;      // cuts up to tips
    double cut_length = 0.0; // total length of the new cuts, internal units
};

/// Cuts one chart that is not sound (see holes.h): marks the new seams in `seam` (3 #F) and returns
/// the chart as a disk, or as a disk with flat holes. `cut_length`, if given, is increased by the
/// length of the new cuts.
ChartSurface cut_to_disk(const Mesh& mesh, ChartSurface surface, std::vector<std::uint8_t>& seam,
                         const Progress& progress, double* cut_length = nullptr,
                         const HoleRule& holes = {});

/// Cuts a chart that is a disk open along shortest paths from its boundary to its tips (see
/// tips.h). Marks the seams, adds their length to `cut_length` and returns their number.
Index cut_to_tips(const Mesh& mesh, const ChartSurface& disk, std::vector<std::uint8_t>& seam,
                  const TipRule& rule, double& cut_length, const Progress& progress);

/// Adds seams inside the charts until each chart is a disk (V − E + F = 1, one boundary loop) or
/// has flat holes beside its rim: shortest paths between the other boundary loops, short cycles
/// through handles, and for a sphere a path between two far vertices. For charts with handles the
/// cheaper one of two constructions is taken: loops joined first and handles by [EHP04], or handles
/// first by [YGZS05]; both join all loops, and so do charts that are cut up to tips.
DiskCuts cut_charts_to_disks(const Mesh& mesh, const ChartMap& charts, const DiskOptions& options,
                             Progress& progress);

/// The same without cuts to tips: charts that are sound are left as they are.
DiskCuts cut_charts_to_disks(const Mesh& mesh, const ChartMap& charts, Progress& progress);

} // namespace devseg::atlas
