// The charts of Multi-Chart Geometry Images: planar and compact by a path cost [SWGSH03].
//
// Cost of a step from a face to the next: (λ + 1 − N · n) times the distance of the centroids, with
// N the mean normal of the chart as it grows. The paper's rules that keep charts disks while they
// grow are left to the cutting of charts to disks, as in the comparison of [YGZS05].
//
// References
//   [SWGSH03] P. V. Sander, Z. J. Wood, S. J. Gortler, J. Snyder, H. Hoppe: Multi-Chart Geometry
//             Images. Symposium on Geometry Processing, 2003. doi:10.2312/SGP/SGP03/146-155
#pragma once

#include <vector>

#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::baselines {

struct McgimOptions {
    int charts_number = 20;
    int max_iterations = 100; // rounds of growing at most, after the start
    int random_seed = 0;      // 0: a start that does not depend on the order of the faces

    static OptionRanges<McgimOptions> ranges() {
        return with_rounds<McgimOptions>(
            {{&McgimOptions::charts_number, {"charts_number", 1, 1e9}}});
    }
};

struct McgimResult {
    std::vector<Index> chart;      // #F; every chart is edge-connected
    std::vector<double> face_cost; // #F: cost of the path from the seed, internal units
    int rounds = 0;
    bool converged = false; // the seeds came back to where they were before
};

/// A mesh of more components than `charts_number` gets one chart for each component. Throws
/// InvalidParameter (1 ≤ charts_number ≤ #F, max_iterations ≥ 1) and Cancelled.
McgimResult segment_mcgim(const Mesh& mesh, const McgimOptions& options, Progress& progress);

} // namespace devseg::baselines
