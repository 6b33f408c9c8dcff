// Faces of a surface in space that run through each other.
#pragma once

#include <utility>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::develop {

/// All pairs (i < j) of triangles that cross, sorted: an edge of one runs through the inside of the
/// other. Triangles with a common edge never cross that way; those with a common vertex may. Mere
/// touching does not count. Corners are equal where their indices are.
std::vector<std::pair<Index, Index>> find_intersections(const std::vector<Vec3>& points,
                                                        const std::vector<Triangle>& faces,
                                                        const Progress& progress);

} // namespace devseg::develop
