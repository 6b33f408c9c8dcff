// Thin faces, which a small move of a vertex turns over: rounding a map to the precision of texture
// coordinates (32 bit), and giving needles their height.
#pragma once

#include <vector>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Rounds uv (#v) to single precision. Faces that are lower than a few steps of the numbers, which
/// rounding could turn over or stretch beyond recognition, get that height first, and push others
/// away where that takes room; the largest coordinate says how large a step is. Returns the number
/// of faces that could not be kept positive: 0, but for maps with flips.
///
/// Source
///   M. Müller, B. Heidelberger, M. Hennix, J. Ratcliff: Position Based Dynamics. Journal of Visual
///   Communication and Image Representation 18(2), 2007. doi:10.1016/j.jvcir.2007.01.005
Index snap_to_single(const std::vector<Triangle>& faces, std::vector<Vec2>& uv);

/// Gives faces that were widened to be flattened (see make_flattening_problem) the height that they
/// have on the surface, or one that 32 bits hold in a packed square, by moving the corner opposite
/// to their longest edge, where no face around it is flipped by that.
void restore_needles(const FlatteningProblem& problem, std::vector<Vec2>& uv);

} // namespace devseg::flatten
