// Connected parts without area, such as single faces whose corners lie on one line.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// 1 for each face (#F) of a connected part that is no wider than this (internal units): by its
/// area, as a strip as long as its longest edge, or by the distances of its vertices from the line
/// of that edge, as it may lie on itself. All 0 where there are no other parts. Reads points, faces
/// and twins.
std::vector<std::uint8_t> find_empty_parts(const Mesh& mesh, double width);

} // namespace devseg::mesh
