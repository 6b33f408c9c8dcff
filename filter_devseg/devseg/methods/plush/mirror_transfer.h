// Seams of a symmetric surface on the model: one half of the model gets them as they are.
#pragma once

#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

/// The seams of a coarser surface with the same plane and side on the surface, both images alike:
/// those of the first half are carried over, those along the plane stay on it. `factor` as for
/// transfer_seams.
SeamMarks seams_in_pairs(const WorkingSurface& from, const SeamMarks& seam,
                         const WorkingSurface& to, const VertexGraph& graph,
                         const std::vector<double>& factor, Progress& progress);

/// The seams on the model: edge by edge on its own half, and on the other one as paths that keep
/// close to the mirror images. `placed`: the surface with its image moved onto the other half.
SeamMarks seams_on_model(const MirroredModel& mirrored, const Mesh& placed, const SeamMarks& seam,
                         const Mesh& model, const VertexGraph& graph, Progress& progress);

} // namespace devseg::plush
