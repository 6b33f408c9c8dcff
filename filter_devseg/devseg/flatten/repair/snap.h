// Thin faces, which a small move of a vertex turns over: rounding a map to the precision of texture
// coordinates (32 bit), and giving needles their height.
#pragma once

#include <vector>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Rounds uv (#v) to single precision. Where rounding would flip or flatten a face of positive
/// orientation, one of its vertices is moved by a few units in the last place until all faces
/// around it are positively oriented again. Returns the number of faces that could not be kept
/// positive.
Index snap_to_single(const std::vector<Triangle>& faces, std::vector<Vec2>& uv);

/// Gives faces that were widened to be flattened (see make_flattening_problem) the height that they
/// have on the surface, and all needles at least a height that 32 bits hold in a packed square, by
/// moving the corner opposite to their longest edge, where no face around it is flipped by that.
void restore_needles(const FlatteningProblem& problem, std::vector<Vec2>& uv);

} // namespace devseg::flatten
