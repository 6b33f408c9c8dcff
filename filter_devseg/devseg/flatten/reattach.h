// Small parts that were cut off because they lay on their chart, hinged to a neighbour where they
// lie on nothing.
#pragma once

#include "devseg/flatten/flatten.h"

namespace devseg {

/// Parts of exact developments that were separated go to a neighbour, also an exact development,
/// the smallest part first: across one edge, which keeps the development exact, that is long enough
/// to hold the part. Returns how many. `tolerance` is a length in the plane.
int reattach_parts(const Mesh& mesh, double tolerance, FlattenResult& result, Progress& progress);

} // namespace devseg
