// Parts of developments that lie on others go to a neighbouring chart, which is deformed once more.
#pragma once

#include <vector>

#include "devseg/develop/deform.h"

namespace devseg::develop {

/// Charts whose developments lie on themselves come apart, as flattening would do it. As long as
/// there are more of them then, parts go to neighbours, the smallest first: glued along the longest
/// piece of their common border where the gap that the paper has to bridge is no wider than a
/// vertex may move, and deformed once more. A part stays where that does not reach the tolerance,
/// moves vertices too far or lies on itself again.
///
/// `mesh` is the one that `result` was made of, which must have converged, its charts sound.
void move_parts(const Mesh& mesh, const std::vector<Index>& point_of, const DeformOptions& options,
                DeformResult& result, Progress& progress);

} // namespace devseg::develop
