// A surface bent until it lies on another one.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/methods/plush/seam_network.h"

namespace devseg::plush {

/// The surface with its points moved onto the model, neighbours by nearly the
/// same: limbs follow those of the model, which are not quite where the mirror
/// image has them. `graph`: of the surface.
Mesh fitted_to(const Mesh& model, const Mesh& surface, const VertexGraph& graph,
               const Progress& progress);

/// Points (#V of `mesh`) that are moved as those of a surface near them.
std::vector<Vec3> moved_along(const Mesh& mesh, const Mesh& surface, const Mesh& moved);

} // namespace devseg::plush
