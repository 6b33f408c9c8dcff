// Seams of a mirrored model on the model itself: one half of it gets them as they are.
#pragma once

#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

/// The seams on the model: edge by edge on its own half, but for teeth, and on the other one as
/// paths that keep close to the mirror images. `placed`: the surface with its image moved onto the
/// other half.
SeamMarks seams_on_model(const MirroredModel& mirrored, const Mesh& placed, const SeamMarks& seam,
                         const Mesh& model, const VertexGraph& graph, Progress& progress);

} // namespace devseg::plush
