// A surface bent until it lies on another one.
#pragma once

#include "devseg/base/progress.h"
#include "devseg/methods/plush/seam_network.h"

namespace devseg::plush {

/// The surface with its points moved onto the model, neighbours by nearly the
/// same: limbs follow those of the model, which are not quite where the mirror
/// image has them. `graph`: of the surface.
Mesh fitted_to(const Mesh& model, const Mesh& surface, const VertexGraph& graph,
               const Progress& progress);

} // namespace devseg::plush
