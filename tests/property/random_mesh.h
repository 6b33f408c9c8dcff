// Small random meshes for the property tests: random genus, boundaries, subdivision, noise, and
// the defects that meshes from elsewhere have.
#pragma once

#include <cstdint>
#include <string>

#include "devseg/mesh/input_gate.h"
#include "unit/mesh_edits.h"

namespace devseg::shapes {

struct RandomMesh {
    mesh::RawMesh raw;
    std::string recipe; // what was done, for the message of a failing case
};

enum class Defects {
    none, // manifold and oriented, every face has an area
    any   // doubled faces, bow-ties, crowded edges, faces without area, needles, odd orientations
};

/// About 2 to 600 faces. The same numbers of `random` give the same mesh everywhere.
RandomMesh random_mesh(Random& random, Defects defects);

/// Turned about a random axis, scaled and moved.
mesh::RawMesh moved_rigidly(const mesh::RawMesh& mesh, double scale, Random& random);

} // namespace devseg::shapes
