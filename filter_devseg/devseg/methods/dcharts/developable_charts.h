// D-Charts, the whole method: charts that grow, straight borders, joined charts, darts.
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/flatten/energy/strain.h"
#include "devseg/methods/dcharts/dcharts.h"

namespace devseg::dcharts {

struct DevelopableChartsOptions : DChartsOptions {
    bool straighten_boundaries = true; // borders as short as the fitting error allows
    bool merge_charts = true;          // join neighbours whose joined map stretches little
    double merge_threshold = 0.01;     // η: how little
    bool add_darts = true;             // cut towards the worst spots of charts
    // With charts_number = 0: the fewest charts whose final map keeps these bounds.
    double max_l2_stretch = 1.01;
    double max_linf_stretch = 0.0; // 0: no bound
    // Of each chart's final map, whatever the number of charts; 0: no bound, the paper alone.
    double max_chart_l2_stretch = 1.02;
    // The same of strain: of 99 % of each chart, and twice as much anywhere. The final map is that
    // of LPFB then.
    double max_strain = 0.0;

    static OptionRanges<DevelopableChartsOptions> ranges();
};

/// How a chart stands to its own bounds: kept, or above them, by no more than the surface's
/// roughness or by more.
enum class Standing : std::uint8_t { kept, rough, above };

struct DevelopableCharts {
    std::vector<Index> chart;          // #F, edge-connected
    std::vector<std::uint8_t> seam;    // 3 #F: darts
    std::vector<double> fitting_error; // #F, F(C, t) with the chart's own proxy
    int rounds = 0;                    // Lloyd rounds that were run
    bool converged = false;            // of the Lloyd rounds
    Index hole_charts = 0;             // charts that hole filling added
    Index joins = 0;                   // of two charts each
    Index darts = 0;                   // cuts inside charts
    // With charts_number = 0, of the symmetric Dirichlet map of the full surface:
    double l2_stretch = 0.0;
    double linf_stretch = 0.0;
    flatten::Strain strain;         // with max_strain: the worst of all charts
    bool bounds_kept = true;        // false: rough charts, and single faces that others lie on
    std::vector<Standing> standing; // #F: of each face's chart
    double roughness = 0.0; // l2² − 1 that no segmentation can remove, mean over the surface
};

/// Segments a coarse version of the surface if it is large (all decisions are made there), takes
/// the charts back to the full surface, and straightens their borders. Throws InvalidParameter for
/// options out of range, and Cancelled.
DevelopableCharts segment_developable_charts(const Mesh& mesh,
                                             const DevelopableChartsOptions& options,
                                             Progress& progress);

} // namespace devseg::dcharts
