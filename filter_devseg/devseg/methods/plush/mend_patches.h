// Small repairs of patches that nearly keep their limits.
#pragma once

#include <optional>
#include <vector>

#include "devseg/methods/plush/patch_trial.h"
#include "devseg/methods/plush/seam_paths.h"

namespace devseg::plush {

/// Cuts that make a patch keep the limits: half-edges, none where it keeps them already. While its
/// map lies on itself, it is cut in two between the sheets; else it gets darts, each from the
/// vertex that a conformal map shrinks most, where curvature gathers, to the nearest seam, so that
/// it may make an earlier dart longer. Nothing where a few cuts are not enough. `cost`: of paths,
/// 3 #F.
std::optional<std::vector<Index>> mend_patch(const Mesh& mesh, const VertexGraph& graph,
                                             const std::vector<double>& cost,
                                             const std::vector<Index>& faces, const SeamMarks& seam,
                                             const PatchLimits& limits, const Progress& progress);

} // namespace devseg::plush
