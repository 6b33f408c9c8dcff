// Closed surfaces whose faces look inwards.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// Marks (#F) the closed surfaces that are inside out, and returns how many they are. Those within
/// the box of another closed surface are the walls of its cavities, and as they should be. `mesh`
/// needs points, faces and twins.
Index find_inside_out(const Mesh& mesh, std::vector<std::uint8_t>& marked);

} // namespace devseg::mesh
