// The methods that others are compared with: Variational Shape Approximation [CSAD04], whose charts
// planes fit best (with the L2,1 metric), and Multi-Chart Geometry Images [SWGSH03], whose charts
// are planar and compact by a path cost.
//
// Cost of a step of the latter: (λ + 1 − N · n) times the distance of the centroids, with N the
// mean normal of the chart as it grows. The paper's rules that keep charts disks while they grow
// are left to the cutting of charts to disks, as in the comparison of [YGZS05].
//
// References
//   [CSAD04] D. Cohen-Steiner, P. Alliez, M. Desbrun: Variational Shape Approximation. ACM
//            Transactions on Graphics 23(3), 2004. doi:10.1145/1015706.1015817
//   [SWGSH03] P. V. Sander, Z. J. Wood, S. J. Gortler, J. Snyder, H. Hoppe: Multi-Chart Geometry
//             Images. Symposium on Geometry Processing, 2003. doi:10.2312/SGP/SGP03/146-155
//   [YGZS05]  H. Yamauchi, S. Gumhold, R. Zayer, H.-P. Seidel: Mesh Segmentation Driven by Gaussian
//             Curvature. The Visual Computer 21, 2005. doi:10.1007/s00371-005-0319-x
#pragma once

#include <vector>

#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::baselines {

struct VsaOptions {
    int charts_number = 20;
    bool teleport_charts = true; // merge two charts and split the worst one where that helps
    int max_iterations = 100;    // rounds of partitioning at most, after the start
    int random_seed = 0;         // 0: a start that does not depend on the order of the faces

    static OptionRanges<VsaOptions> ranges() {
        return with_rounds<VsaOptions>({{&VsaOptions::charts_number, {"charts_number", 1, 1e9}}});
    }
};

struct VsaResult {
    std::vector<Index> chart;       // #F; every chart is edge-connected
    std::vector<double> face_error; // #F: |n − N|² of the face's normal and its chart's, 0 to 4
    std::vector<Vec3> proxies;      // the normal N of each chart
    double total_error = 0.0;       // Σ area · |n − N|², internal units squared
    int rounds = 0;
    bool converged = false; // the last round did not lower the error, and no teleport helped
    Index teleports = 0;
};

/// A mesh of more components than `charts_number` gets one chart for each component. Throws
/// InvalidParameter (1 ≤ charts_number ≤ #F, max_iterations ≥ 1) and Cancelled.
VsaResult segment_vsa(const Mesh& mesh, const VsaOptions& options, Progress& progress);

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
