// Splitting a chart that is stretched too much.
#pragma once

#include "devseg/methods/dcharts/dcharts.h"
#include "devseg/methods/dcharts/draft.h"

namespace devseg::dcharts {

/// Grows two D-Charts within the chart, far from each other, and gives the second and what it left
/// over labels of their own. Cuts inside the chart are healed. Returns whether the chart is in
/// parts now; false for a single face.
bool split_chart(const Mesh& mesh, const DChartsOptions& options, double wanted_l2, Index chart,
                 Draft& draft, Progress& progress);

/// The same with the two parts that two planes fit best, where one cone fits all of the chart but
/// for a few faces.
bool halve_chart(const Mesh& mesh, double wanted_l2, Index chart, Draft& draft, Progress& progress);

} // namespace devseg::dcharts
