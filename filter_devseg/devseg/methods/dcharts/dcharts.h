// D-Charts: quasi-developable segmentation into unions of cones [JKS05].
//
// What is here: sections 2, 3.1 and 3.2 of the paper (Lloyd iterations, hole filling). The
// post-processing of section 3.3 (straight boundaries, merging, darts) is in developable_charts.h.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"
#include "devseg/metrics/conic_proxy.h"

namespace devseg::dcharts {

struct DChartsOptions {
    int charts_number = 10;         // initial estimate; hole filling may add charts
    double max_fitting_error = 0.2; // F_max: bound of the fitting error while growing
    double alpha = 1.0;             // weight of developability, exponent of F
    double beta = 0.7;              // weight of roundness, exponent of C
    double gamma = 0.5;             // weight of straight boundaries, exponent of P
    int max_iterations = 100;       // Lloyd rounds at most
    int random_seed = 0;            // 0: a start that does not depend on the order of the faces

    static OptionRanges<DChartsOptions> ranges(); // but of charts_number
};

struct DChartsResult {
    std::vector<Index> chart;          // #F, 0 … proxies − 1; every chart is edge-connected
    std::vector<double> fitting_error; // #F, F(C, t) with the chart's final proxy
    std::vector<metrics::ConicProxy> proxies; // one for each chart
    int rounds = 0;                           // Lloyd rounds that were run
    bool converged = false; // fewer than 5 % of the faces changed in the last round
    Index hole_charts = 0;  // charts that hole filling added
};

/// Throws InvalidParameter for options out of range (1 ≤ charts_number ≤ #F, F_max > 0,
/// exponents ≥ 0, max_iterations ≥ 1) and Cancelled.
DChartsResult segment_dcharts(const Mesh& mesh, const DChartsOptions& options, Progress& progress);

/// F(C, t) of each face (#F) in the proxy of its chart.
std::vector<double> fitting_errors(const Mesh& mesh, const std::vector<Index>& chart,
                                   const std::vector<metrics::ConicProxy>& proxies);

} // namespace devseg::dcharts
