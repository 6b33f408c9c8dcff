// What was cut off a chart, joined to a neighbour that has room for it.
#pragma once

#include "devseg/flatten/flatten.h"

namespace devseg::flatten {

/// Joins parts that were cut off and are too small to be charts of their own to a neighbour, along
/// their whole common border, where its map stays one-to-one and is stretched little more; the
/// others stay. Parts may lie on each other by `tolerance`. Keeps result.charts and result.flat in
/// step.
void hand_over_slivers(const Mesh& mesh, FlattenMethod method, double tolerance,
                       FlattenResult& result, Progress& progress);

/// Parts of exact developments that were separated go to a neighbour, also an exact development,
/// the smallest part first: across one edge, which keeps the development exact, that is long enough
/// to hold the part. Returns how many. `tolerance` is a length in the plane.
int reattach_parts(const Mesh& mesh, double tolerance, FlattenResult& result, Progress& progress);

} // namespace devseg::flatten
