// Models of several materials: which of them each piece is cut from.
#pragma once

#include <string>
#include <vector>

#include "devseg/mesh/mesh.h"
#include "devseg/pattern/pattern.h"

namespace devseg::sheet {

/// Sets PatternPiece::fabric and Pattern::fabrics from the material of each face (#F of the mesh
/// that the pattern was made of; empty or one number: nothing to do). A piece is cut from what most
/// of its area is of; a note names pieces whose faces differ. Pieces of one shape stay such where
/// they are of one material. `names` are those of the numbers in ascending order, with commas;
/// where it is empty, "material 3" is that of number 3. Throws
/// InvalidParameter where there are not as many names as materials.
void set_fabrics(const std::vector<Index>& face_material, const std::string& names,
                 pattern::Pattern& pattern);

} // namespace devseg::sheet
