// The bounds that the final map of the full surface keeps: what is above them is cut until it is
// not. That ends, because single faces are isometric.
#pragma once

#include "devseg/judge/final_map.h"
#include "devseg/methods/dcharts/developable_charts.h"
#include "devseg/methods/dcharts/joins.h"

namespace devseg::dcharts {

/// Bounds of the final map, 0 or infinite where there is none.
struct FinalBounds {
    double chart_l2 = 0.0;        // L2 stretch of each chart, above the roughness
    double roughness = 0.0;       // l2² − 1 that no segmentation can remove
    double linf = 0.0;            // stretch of the worst spot
    double strain = 0.0;          // of 99 % of each chart, twice as much anywhere; above roughness
    double max_excess = infinite; // Σ A (l2² − 1) over the charts, internal units squared
    bool add_darts = true;        // where they bring a chart within its bound
    bool may_cut = true;          // else the charts are only judged

    /// Of this share of the bound, and what the roughness adds; infinite without a bound.
    double allowed_strain(double share) const;
    /// Of the final map: what is sewn keeps the lengths of its seams.
    judge::MapFor purpose() const {
        return strain > 0.0 ? judge::MapFor::cloth : judge::MapFor::texture;
    }
};

/// Judges every chart by its final map. Charts above a bound get darts where these are enough, and
/// are split otherwise; what was split is joined again where the final map allows it. Fills in the
/// stretch of the whole where it is bounded, and what is still above a bound: charts of single
/// faces and rough ones. False where a chart was cut, or would have to be.
bool keep_bounds(const Mesh& mesh, const FinalBounds& bounds, const DChartsOptions& growing,
                 const MergeOptions& merging, DevelopableCharts& charts, Progress& progress);

} // namespace devseg::dcharts
