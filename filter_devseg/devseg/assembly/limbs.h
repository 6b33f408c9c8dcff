// Limbs of solids, by the branches of a curve skeleton: arms, legs, heads.
//
// References
//   [HSKK01] M. Hilaga, Y. Shinagawa, T. Kohmura, T. L. Kunii: Topology Matching for Fully
//   Automatic
//            Similarity Estimation of 3D Shapes. SIGGRAPH 2001. doi:10.1145/383259.383282
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::assembly {

struct Limbs {
    std::vector<Index> of_face; // #F: 0, 1, …, or −1: a body
    Index count = 0;
};

/// The mean distance on the surface from places all over it is least at the middle and most at the
/// tips of limbs [HSKK01]. From the tips inwards, regions grow by that distance, and meet where
/// limbs branch off. Regions that meet are limbs where they are large, and long beside the place
/// where they meet; what is smaller is a part of what it meets. What comes after limbs have met is
/// the body. Each connected part of the mesh has limbs of its own, or none. Throws Cancelled.
Limbs find_limbs(const Mesh& mesh, const Progress& progress);

} // namespace devseg::assembly
