// Darts for patches that are not developable enough by little.
#pragma once

#include <optional>
#include <vector>

#include "devseg/plush/patch_trial.h"
#include "devseg/plush/seam_paths.h"

namespace devseg {

/// Darts that make a patch keep the limits: half-edges, none where it keeps them already. Each
/// leads from the vertex that a conformal map of the patch shrinks most, where curvature gathers,
/// to the nearest seam, so that it may make an earlier dart longer. Nothing where a few are not
/// enough. `cost`: of paths, 3 #F.
std::optional<std::vector<Index>> find_darts(const Mesh& mesh, const VertexGraph& graph,
                                             const std::vector<double>& cost,
                                             const std::vector<Index>& faces, const SeamMarks& seam,
                                             const PatchLimits& limits, const Progress& progress);

} // namespace devseg
