// Flat faces of several triangles: whole in one chart, with cuts led around them.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::atlas {

/// Gives every flat region to the chart that has most of it. What comes new to a chart is glued
/// within its plane, and hangs on the rest by its longest edges, one for each part. Charts may fall
/// apart or vanish; they need not be sound then.
ChartMap keep_flat_faces_whole(const Mesh& mesh, const ChartMap& charts);

/// Glues the cuts inside charts that run between faces of one plane, and opens the charts anew:
/// shortest paths lead from their border to each vertex that is not flat (`cost` (#V, radians)
/// above `flat`) and had a cut, and to the loops that are left. The charts whose cuts cost less
/// then (see cut_cost) get the new ones. Charts stay sound.
void lead_around_flat_faces(const Mesh& mesh, const std::vector<double>& cost, double flat,
                            ChartMap& charts, Progress& progress);

} // namespace devseg::atlas
