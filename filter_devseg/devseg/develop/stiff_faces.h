// Flat faces with holes stay flat: a hole in a chart unfolds exactly only as long as nothing moves
// around it, and angles at inner vertices do not tell.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::develop {

struct StiffFaces {
    std::vector<Vec3> points;        // #V: the mesh's, with these faces exactly in their planes
    std::vector<std::uint8_t> fixed; // by point: 1 for those of these faces
};

/// The flat regions of a thousandth of the surface or more that have holes. `point_of` as in
/// deform_to_developable. Regions stay as they are, and movable, that have no plane of their own
/// beside each other.
StiffFaces find_stiff_faces(const Mesh& mesh, const std::vector<Index>& point_of);

/// The mesh with other points.
Mesh with_points(const Mesh& mesh, const std::vector<Vec3>& points);

} // namespace devseg::develop
