// Faces that lie on top of one another in the plane.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "devseg/base/numbers.h"

namespace devseg::plane {

/// All pairs (i < j) of triangles whose interiors overlap, by the separating axis test. Triangle i
/// has its corners at corners[3 i] … corners[3 i + 2]. Touching by less than a millionth of the
/// smaller triangle's size, or by less than `tolerance`, does not count, and triangles without area
/// overlap nothing. Sorted.
std::vector<std::pair<Index, Index>> find_overlapping_pairs(const CornerUv& corners,
                                                            double tolerance);

/// Whether there are any: stops at the first.
bool any_overlap(const CornerUv& corners, double tolerance);

/// What coordinates of 32 bit can tell apart in a layout of the given extent: the tolerance for
/// find_overlapping_pairs.
double layout_tolerance(double extent);

/// 1 for each face that overlaps another one in the plane by more than its coordinates' rounding.
std::vector<std::uint8_t> find_overlapping_faces(const CornerUv& uv);

} // namespace devseg::plane
