// One chart in the plane.
#pragma once

#include <vector>

#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/flatten/flatten.h"

namespace devseg::flatten {

/// What a part hangs on when it goes to another chart: at least this length over the root of the
/// part's area, as shorter edges do not hold it on paper.
constexpr double least_hinge = 0.3;

/// Flattens chart.surface, which is sound (see atlas/holes.h), and fills in the rest of `chart`.
/// Returns the half-edges of the mesh to cut where parts overlap in the plane and could not be
/// pushed apart, or where there is no map around holes; nothing where the map is one-to-one.
/// `whole`: it must stay in one piece, and is `torn` where it does not; nothing is to be cut.
std::vector<HalfEdge> flatten_one(const Mesh& mesh, FlattenMethod method, FlatChart& chart,
                                  const Progress& progress, const WholeChart* whole = nullptr);

/// The half-edges of the mesh to cut so that the chart's holes open to its rim; nothing for disks.
std::vector<HalfEdge> open_holes(const Mesh& mesh, const atlas::ChartSurface& surface,
                                 const Progress& progress);

/// The chart's exact development, which every method looks for; false where it has none. Parts may
/// overlap. `problem` is that of chart.surface.
bool develop(const Mesh& mesh, const FlatteningProblem& problem, FlatChart& chart);

} // namespace devseg::flatten
