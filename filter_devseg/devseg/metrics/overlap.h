// Faces that lie on top of one another in the plane.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/texture.h"

namespace devseg {

/// 1 for each face whose interior overlaps another face's in the plane (#F), by the separating
/// axis test; touching by less than a millionth of the smaller triangle's size does not count.
/// Faces of no area in the plane overlap nothing.
std::vector<std::uint8_t> find_overlapping_faces(const Mesh& mesh, const CornerUv& uv);

} // namespace devseg
