// Vertices at the same place, joined.
#pragma once

#include "devseg/mesh/input_gate.h"

namespace devseg::mesh {

/// Files such as STL hold separate triangles: where no two faces share a vertex, those with the
/// same coordinates become one in `faces`. Returns how many there are less, 0 for any other mesh.
/// Indices must be in range.
Index weld_soup(const RawMesh& raw, std::vector<Triangle>& faces);

/// Faces of the mesh with new vertex indices: files that give every vertex one place in the texture
/// are cut along all seams, and the two sides of a cut have the same coordinates to the last bit.
struct WeldedMesh {
    RawMesh mesh;    // points as they were, faces with the first of the vertices at a place
    Index edges = 0; // pairs of border edges that were joined
};

/// Joins the ends of border edges that lie on exactly one other border edge. Nothing is joined
/// where that would put two faces on the same three vertices, as in sheets with two coincident
/// layers. Indices must be in range.
WeldedMesh weld_borders(const RawMesh& raw);

} // namespace devseg::mesh
