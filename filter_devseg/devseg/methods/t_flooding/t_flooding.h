// t-flooding: segmentation that spreads Gauss area evenly over a given number of charts [YGZS05].
//
// Differences from the paper: candidates behind a long crease wait until no chart has another
// one, as a straight crease sweeps no Gauss area and would not stop a chart. Seeds that come back
// to where they were, or no longer help, rest while the offsets go on with a smaller damping
// factor. At the end borders are made short (see balanced_borders.h).
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::t_flooding {

struct TFloodingOptions {
    int charts_number = 20;
    double crease_angle = 45.0;        // T_a, degrees: sharper edges split normals
    double speed_power = 1.0;          // p of the speed function f(x) = (x + ε)^p
    double speed_epsilon = 1e-4;       // ε, as a fraction of the largest curvature
    double offset_damping = 0.9;       // β: share of the imbalance that the next round takes up
    bool straighten_boundaries = true; // short borders that keep the balance
    int max_iterations = 100;          // rounds of flooding at most
    int random_seed = 0;               // 0: a start that does not depend on the order of the faces

    static OptionRanges<TFloodingOptions> ranges();
};

struct TFloodingResult {
    std::vector<Index> chart;             // #F; every chart is edge-connected
    std::vector<double> face_gauss_area;  // #F, steradians
    std::vector<double> chart_gauss_area; // one for each chart, steradians
    double gauss_area_std = 0.0;          // their standard deviation, steradians
    double total_gauss_area = 0.0;        // of all elements of the mesh, steradians
    int rounds = 0;
    bool converged = false; // ended by balance or by its standstill, not by max_iterations
};

/// A mesh of more components than `charts_number` gets one chart for each component.
///
/// Throws InvalidParameter for options out of range (1 ≤ charts_number ≤ #F, 0 < crease_angle ≤
/// 180, 0 ≤ speed_power ≤ 6, 0 < speed_epsilon ≤ 1, 0 < offset_damping ≤ 1, max_iterations ≥ 1) and
/// Cancelled.
TFloodingResult segment_t_flooding(const Mesh& mesh, const TFloodingOptions& options,
                                   Progress& progress);

} // namespace devseg::t_flooding
