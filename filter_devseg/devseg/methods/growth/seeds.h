// Farthest-point seeds: start faces that are far from one another along the surface.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::growth {

/// `count` distinct faces; each next one is farthest from those before, along paths over face
/// centroids; other connected components count as infinitely far. Seed value 0 starts at the face
/// farthest from the centre of the surface, whatever the order of the faces; other values start
/// at a random face.
std::vector<Index> farthest_point_seeds(const Mesh& mesh, Index count, std::uint32_t random_seed,
                                        Progress& progress);

/// Charts never join components: as many charts as asked for, and at least one for each component.
inline Index at_least_one_per_component(const Mesh& mesh, int charts_number) {
    return std::max(static_cast<Index>(charts_number),
                    mesh::face_components(mesh, [](Index) { return true; }).count);
}

} // namespace devseg::growth
