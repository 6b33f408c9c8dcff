// Meshes as learned generators make them: thin sheets that are glued together, with walls inside,
// and bits that float around.
#pragma once

#include "devseg/mesh/input_gate.h"
#include "unit/mesh_edits.h"

namespace devseg::shapes {

/// The walls of a foam: a ball on a lattice of `cells` cells along its diameter, divided into
/// `bubbles` parts, with two triangles for each square between two of them. Where three bubbles
/// meet, and along the steps of the lattice, edges have three or four faces: the more bubbles, the
/// more of them. `bits` tetrahedra float around. About 6 cells² faces without bubbles.
mesh::RawMesh foam(Random& random, Index cells, Index bubbles, Index bits);

/// The share of edges that have more than two faces.
double crowded_share(const mesh::RawMesh& raw);

} // namespace devseg::shapes
