// Joining the boundary loops of a chart by short cuts.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::atlas {

/// Half-edges (local, one for each edge) of cuts that join all boundary loops into one. Starting
/// from the longest loop, the nearest loop is joined by a shortest path to all that is joined
/// already, cuts included (Prim's algorithm with paths; see cut_cost). Loops with a 1 in `kept`
/// (#loops, may be empty) need not be joined; a path that meets one of them goes on from any place
/// on it.
std::vector<Index> join_loops(const Mesh& mesh, const ChartSurface& surface,
                              const std::vector<std::uint8_t>& kept, const Progress& progress);

/// The half-edges that leave each vertex through the inside of the chart: the ways for cuts.
Buckets<HalfEdge> inner_half_edges(const ChartSurface& surface); // #v

double loop_length(const Mesh& mesh, const ChartSurface& surface, const std::vector<Index>& loop);

} // namespace devseg::atlas
