// Seams around limbs: where arms, legs, ears and tails meet the body.
//
// References
//   S. Katz, A. Tal: Hierarchical Mesh Decomposition Using Fuzzy Clustering and Cuts. ACM
//   Transactions on Graphics 22(3), 2003. doi:10.1145/882262.882369 (the cut along concavities)
#pragma once

#include "devseg/methods/plush/seam_network.h"

namespace devseg::plush {

/// One limb: the faces from its tip to its root.
struct Limb {
    Index tip = -1;           // vertex
    std::vector<Index> faces; // ascending
};

/// The limbs that end at the given tips: the surface around a tip widens suddenly at the limb's
/// root; there it is cut by the least cut in which concave edges are cheap (`curvature`: mean
/// curvature, #V). Limbs that are much the same count once; the largest come first.
std::vector<Limb> find_limbs(const Mesh& mesh, const VertexGraph& graph,
                             const std::vector<double>& curvature, const std::vector<Index>& tips,
                             const Progress& progress);

/// The half-edges of its faces on the border of a limb.
std::vector<Index> limb_border(const Mesh& mesh, const Limb& limb);

} // namespace devseg::plush
