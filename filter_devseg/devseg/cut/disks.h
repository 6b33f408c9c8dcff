// Cutting charts open until each is a topological disk.
//
// References
//   [EHP04] J. Erickson, S. Har-Peled: Optimally Cutting a Surface into a Disk. Discrete &
//           Computational Geometry 31, 2004. doi:10.1007/s00454-003-2948-z (the greedy tree–cotree
//           construction, once all boundary loops are joined)
#pragma once

#include "devseg/mesh/charts.h"
#include "devseg/progress.h"

namespace devseg {

struct DiskCuts {
    ChartMap charts;         // the same charts with more seams
    Index cut_charts = 0;    // charts that had to be cut
    double cut_length = 0.0; // total length of the new cuts, internal units
};

/// Cuts one chart: marks the new seams in `seam` (3 #F) and returns the chart as a disk.
/// `cut_length`, if given, is increased by the length of the new cuts.
ChartSurface cut_to_disk(const Mesh& mesh, ChartSurface surface, std::vector<std::uint8_t>& seam,
                         double* cut_length = nullptr);

/// Adds seams inside the charts until each chart is a disk (V − E + F = 1, one boundary loop):
/// shortest paths between boundary loops, short cycles through handles, and for a sphere a path
/// between two far vertices. Charts that are disks are left as they are.
DiskCuts cut_charts_to_disks(const Mesh& mesh, const ChartMap& charts, Progress& progress);

} // namespace devseg
