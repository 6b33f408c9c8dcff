// Small pieces that no chart needs.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::atlas {

/// Gives edge-connected pieces of a label that are smaller than `share` of the surface to the
/// neighbour with the longest common border, the smallest piece first. Pieces without neighbours
/// stay. Returns edge-connected labels 0 … n − 1; `label` is #F.
std::vector<Index> absorb_fragments(const Mesh& mesh, const std::vector<Index>& label,
                                    double share);

} // namespace devseg::atlas
