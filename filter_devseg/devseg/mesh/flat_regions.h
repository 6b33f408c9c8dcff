// Faces of one plane: polygons of the file, walls, boards. To a person each is one face.
#pragma once

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// Edge-connected faces in one plane, to within what 32-bit coordinates can tell: one label for
/// each face, in the order of each region's first face. Faces of curved parts are regions of their
/// own.
FaceComponents flat_regions(const Mesh& mesh);

/// Gives all faces of a flat region the label that covers most of its area, if the region has at
/// least `share` of the surface; `label` is #F. A label may fall apart or vanish.
void keep_regions_whole(const Mesh& mesh, double share, std::vector<Index>& label);

/// 1 for each half-edge (3 #F) within a flat region that has at least `share` of the surface.
std::vector<std::uint8_t> within_flat_regions(const Mesh& mesh, double share);

} // namespace devseg::mesh
