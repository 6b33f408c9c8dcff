// Edges without length: modellers close holes and tubes by drawing all their vertices to one place.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// Vertices at the same place that edges join become one in `faces`: faces between them then repeat
/// a vertex. Where that would lay faces on each other, or more than two at an edge, as where sheets
/// without thickness hang together along their rims, they stay apart, and the faces between them
/// alone repeat one, but those at edges of more than two: the borders that are left lie on each
/// other. Returns how many vertices there are less. Indices must be in range.
Index join_ends_of_empty_edges(const std::vector<Vec3>& points, std::vector<Triangle>& faces);

} // namespace devseg::mesh
