// Faces that are thinner than the methods can work with.
#pragma once

#include <vector>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Gives faces that were widened to be flattened (see make_flattening_problem) the height that they
/// have on the surface, by moving the corner opposite to their longest edge, where no face around
/// it is flipped by that.
void restore_needles(const Mesh& mesh, const atlas::ChartSurface& surface,
                     const FlatteningProblem& problem, std::vector<Vec2>& uv);

} // namespace devseg::flatten
