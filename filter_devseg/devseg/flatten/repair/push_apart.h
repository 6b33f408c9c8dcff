// Parts of one chart that lie on each other in the plane, pushed apart with little change of shape.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// The map with its overlapping parts pushed apart by a penalty on contacts; `pairs` are the faces
/// that overlap (overlaps.h). Nothing if that does not help, or costs too much shape: then a cut
/// keeps the pattern truer. `gap_share` is the distance to leave, of the chart's size.
std::optional<std::vector<Vec2>>
push_apart(const FlatteningProblem& problem, const atlas::ChartSurface& surface,
           std::vector<Vec2> uv, std::vector<std::pair<Index, Index>> pairs, double tolerance,
           const Progress& progress, double gap_share = 3e-4);

} // namespace devseg::flatten
