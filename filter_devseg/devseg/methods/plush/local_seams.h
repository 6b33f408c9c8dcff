// Further seams where patches are not developable enough yet.
#pragma once

#include "devseg/methods/plush/patch_trial.h"
#include "devseg/methods/plush/seam_paths.h"
#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

struct LocalSeams {
    Index splits = 0; // patches that were split
    bool all_developable = true;
};

/// Makes every patch a disk, and splits those that do not keep the limits,
/// along the isoline half way to their worst spot, or where that is too small a part of the patch,
/// by a path through the worst spot, until all are developable. Marks stay symmetric where the
/// surface is. `settled`: 1 for faces of patches that are developable (#F), or empty.
LocalSeams add_local_seams(const WorkingSurface& surface, const VertexGraph& graph,
                           const std::vector<double>& weight, const PatchLimits& limits,
                           std::vector<std::uint8_t> settled, SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
