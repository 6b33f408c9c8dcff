// Connected parts without area, such as single faces whose corners lie on one line.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// 1 for each face (#F) of a connected part with no more area than a strip of this width (internal
/// units) that is as long as the part's longest edge, or as both sides of one where the part is
/// closed. All 0 where there are no other parts. Reads points, faces and twins.
std::vector<std::uint8_t> find_empty_parts(const Mesh& mesh, double width);

} // namespace devseg::mesh
