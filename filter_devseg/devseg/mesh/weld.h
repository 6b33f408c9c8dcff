// Vertices at the same place: files give a vertex to each normal, each texture coordinate or even
// each triangle, and the surface is open where it should not be.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// Files such as STL hold separate triangles: where no two faces share a vertex, those at the same
/// place, up to `tolerance` (units of the points), become one in `faces`. Returns how many there
/// are less, 0 for any other mesh. Indices must be in range.
Index weld_soup(const std::vector<Vec3>& points, double tolerance, std::vector<Triangle>& faces);

/// Pairs of boundary half-edges that lie on each other up to `tolerance` (internal units), and
/// should be one edge: the faces run along it in opposite directions, and no face lies on its
/// partner. Where more than two meet, as where solids touch, pairs are those with nothing but their
/// inside between them; a half-edge without a partner stays alone. `mesh` needs points, faces and
/// twins; half-edges that are `left_out` (3 #F) have no partner.
std::vector<std::array<HalfEdge, 2>> coincident_borders(const Mesh& mesh,
                                                        const std::vector<std::uint8_t>& left_out,
                                                        double tolerance, const Progress& progress);

} // namespace devseg::mesh
