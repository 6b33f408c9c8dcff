// The layout that a host's mesh shows by its texture coordinates.
#pragma once

#include <array>
#include <vector>

#include "devseg/mesh/mesh.h"
#include "host/meshlab_api.h"

namespace devseg::host {

using FaceUv = std::array<Vec2, 3>;

/// Texture coordinates of the live faces, from the wedges or else from the vertices, with the
/// charts of all texture images side by side; none where the mesh has none.
std::vector<FaceUv> read_layout_uv(const MeshModel& model);

} // namespace devseg::host
