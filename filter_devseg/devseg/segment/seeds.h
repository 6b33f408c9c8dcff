// Farthest-point seeds: start faces that are far from one another along the surface.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"
#include "devseg/progress.h"

namespace devseg {

/// `count` distinct faces; each next one is farthest from those before, along paths over face
/// centroids; other connected components count as infinitely far. Seed value 0 starts at the face
/// farthest from the centre of the surface, whatever the order of the faces; other values start
/// at a random face.
std::vector<Index> farthest_point_seeds(const Mesh& mesh, Index count, std::uint32_t random_seed,
                                        Progress& progress);

} // namespace devseg
