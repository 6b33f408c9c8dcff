// A mesh cut open along its seams.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/refinement.h"

namespace devseg::atlas {

/// The same faces, with a vertex of its own for each fan of faces that hangs together across edges
/// without a mark (`seam`, 3 #F): the first fan keeps the vertex, the others get new ones at the
/// same place.
mesh::Refinement open_along(const Mesh& mesh, const std::vector<std::uint8_t>& seam);

} // namespace devseg::atlas
