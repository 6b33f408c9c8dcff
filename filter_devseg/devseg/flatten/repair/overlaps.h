// Parts of one chart that lie on top of each other in the plane, and how to cut them apart.
//
// References
//   [LPRM02] B. Lévy, S. Petitjean, N. Ray, J. Maillot: Least Squares Conformal Maps for Automatic
//            Texture Atlas Generation. ACM Transactions on Graphics 21(3), 2002, section 3.2.
#pragma once

#include <utility>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::flatten {

/// Whether the boundary of a map without flips crosses itself: exact orientation tests of boundary
/// edges against boundary edges over a grid. A map of a disk without flips whose boundary does not
/// cross itself is one-to-one.
bool boundary_crosses_itself(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv);

/// Pairs of faces that overlap by more than `tolerance` (a length in the plane); empty when the
/// boundary does not cross itself.
std::vector<std::pair<Index, Index>> overlapping_pairs(const atlas::ChartSurface& surface,
                                                       const std::vector<Vec2>& uv,
                                                       double tolerance);

/// Half-edges of the surface that cut it in two along a short path, such that the two faces of the
/// first overlapping pair, with as many of the faces around them that take part in the overlap as
/// possible, come apart. Half-edges are local, one for each edge.
std::vector<Index> separating_path(const Mesh& mesh, const atlas::ChartSurface& surface,
                                   const std::vector<std::pair<Index, Index>>& pairs,
                                   const Progress& progress = Progress());

} // namespace devseg::flatten
