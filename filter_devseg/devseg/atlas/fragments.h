// Small pieces and single faces that no chart needs.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::atlas {

/// Gives edge-connected pieces of a label that are smaller than `share` of the surface to the
/// neighbour with the longest common border, the smallest piece first. Pieces without neighbours
/// stay. Returns edge-connected labels 0 … n − 1; `label` is #F.
std::vector<Index> absorb_fragments(const Mesh& mesh, const std::vector<Index>& label,
                                    double share);

/// Gives faces that stick out of their label, with two edges to one other label, to that one, again
/// and again.
void remove_teeth(const Mesh& mesh, std::vector<Index>& label);

} // namespace devseg::atlas
