// Roughness: stretch that no segmentation can remove, because it is in every small neighbourhood.
#pragma once

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::judge {

struct Roughness {
    double excess = 0.0; // l2² − 1, the median of the neighbourhoods
    double linf = 1.0;   // the largest stretch in any of them
};

/// Of the flattened neighbourhoods of the mesh's faces: of three rings around a face, or of what
/// lies within 1 % of the model's size if that is more, and less than that on surfaces of few
/// faces. Taken at some of the faces, evenly spread. All cores; only the thread that runs the
/// filter may call it.
Roughness roughness(const Mesh& mesh, Progress& progress);

} // namespace devseg::judge
