#include "devseg/mesh/surface_search.h"

#include <algorithm>

namespace devseg::mesh {

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
    std::vector<Vec3> normal(mesh.points.size(), Vec3::Zero());
    for (const HalfEdge h : mesh.all_half_edges())
        normal[mesh.origin(h)] += mesh.face_areas[face_of(h)] * mesh.face_normals[face_of(h)];
    for (Vec3& n : normal)
        n = n.stableNormalized();
    return normal;
}

Vec3 nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto on_edge = [&](const Vec3& u, const Vec3& v) -> Vec3 {
        const Vec3 e = v - u;
        const double t = e.squaredNorm() > 0.0 ? (p - u).dot(e) / e.squaredNorm() : 0.0;
        return u + std::clamp(t, 0.0, 1.0) * e;
    };
    const Vec3 n = (b - a).cross(c - a);
    if (n.squaredNorm() > 0.0 && n.cross(b - a).dot(p - a) >= 0.0 &&
        n.cross(c - b).dot(p - b) >= 0.0 && n.cross(a - c).dot(p - c) >= 0.0)
        return p - n * (n.dot(p - a) / n.squaredNorm());
    Vec3 best = on_edge(a, b);
    for (const Vec3& q : {on_edge(b, c), on_edge(c, a)})
        if ((q - p).squaredNorm() < (best - p).squaredNorm())
            best = q;
    return best;
}

} // namespace devseg::mesh
