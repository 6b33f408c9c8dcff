// Angle defects: what is missing to 2π around a vertex. A surface whose inner vertices have none is
// a folded sheet of paper.
#pragma once

#include <cmath>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// Angle of the triangle v a b at v, in radians, from 0 to π; exact for thin triangles too.
inline double corner_angle(const Vec3& v, const Vec3& a, const Vec3& b) {
    return std::atan2((a - v).cross(b - v).norm(), (a - v).dot(b - v));
}

/// 2π minus the angles of all faces around each vertex (#V), in radians; 0 on the mesh's boundary.
std::vector<double> angle_defects(const Mesh& mesh);

/// A half-edge that leaves each vertex (#V), on the mesh's boundary the one from which visit_star
/// goes around all faces without turning back; −1 at vertices without faces.
std::vector<Index> leaving_half_edges(const Mesh& mesh);

/// 1 for each vertex (#V) on the mesh's boundary.
std::vector<std::uint8_t> boundary_vertices(const Mesh& mesh);

} // namespace devseg::mesh
