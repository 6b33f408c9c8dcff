// Roughness: stretch that no segmentation can remove, because it is in every small neighbourhood.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::judge {

/// l2² − 1 of the flat neighbourhoods of the faces, the mean over their area: of three rings around
/// a face, or of what lies within 1 % of the model's size if that is more, and less than that on
/// surfaces of few faces. Taken at some of the faces (ascending), evenly spread. All cores; only
/// the thread that runs the filter may call it.
double roughness(const Mesh& mesh, const std::vector<Index>& faces, Progress& progress);

} // namespace devseg::judge
