// Rounding a map to the precision of texture coordinates (32 bit) without turning a face over.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::flatten {

/// Rounds uv (#v) to single precision. Where rounding would flip or flatten a face of positive
/// orientation, one of its vertices is moved by a few units in the last place until all faces
/// around it are positively oriented again. Returns the number of faces that could not be kept
/// positive.
Index snap_to_single(const std::vector<Triangle>& faces, std::vector<Vec2>& uv);

} // namespace devseg::flatten
