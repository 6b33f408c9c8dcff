// What is left over where charts were cut apart.
#pragma once

#include "devseg/flatten/flatten.h"

namespace devseg {

/// Joins parts that were cut off and are too small to be charts of their own to a neighbour, where
/// its map stays one-to-one and is stretched little more; the others stay. Parts may lie on each
/// other by `tolerance`. Keeps result.charts and result.flat in step.
void hand_over_slivers(const Mesh& mesh, FlattenMethod method, double tolerance,
                       FlattenResult& result, Progress& progress);

} // namespace devseg
