// The loop of D-Charts on charts that somebody else has made: short borders, joins, darts, bounds.
#pragma once

#include "devseg/methods/dcharts/developable_charts.h"

namespace devseg::dcharts {

struct RefineOptions {
    bool straighten_boundaries = true;  // borders as short as the fitting error allows
    bool merge_charts = false;          // join neighbours that keep the bounds together
    bool add_darts = true;              // where few of them bring a chart within its bound
    double max_chart_l2_stretch = 1.02; // of each chart's final map, above the roughness
    double max_linf_stretch = 0.0;      // of the worst spot; 0: no bound
    double max_l2_stretch = 0.0;        // of all charts together; 0: no bound

    static OptionRanges<RefineOptions> ranges();
};

/// Brings given charts within their bounds without growing anew: borders become short within the
/// faces that fit both charts, charts above a bound get darts or are split, and what was split is
/// joined again where its final map allows it. Cuts that end inside a chart stay darts to the same
/// vertex; other cuts inside charts are those that make disks of them. Throws InvalidParameter for
/// options out of range, and Cancelled.
DevelopableCharts refine_charts(const Mesh& mesh, const atlas::ChartMap& given,
                                const RefineOptions& options, Progress& progress);

} // namespace devseg::dcharts
