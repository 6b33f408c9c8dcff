// Places on a surface near given points.
#pragma once

#include <utility>
#include <vector>

#include "devseg/mesh/angle_defects.h"
#include "devseg/mesh/nearest_points.h"

namespace devseg::mesh {

/// Unit normals at vertices, means of the faces' weighted by area. #V.
std::vector<Vec3> vertex_normals(const Mesh& mesh);

Vec3 nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Places on the surface near given points.
class SurfaceSearch {
public:
    explicit SurfaceSearch(const Mesh& mesh)
        : mesh_(mesh), points_(mesh.points), leaving_(leaving_half_edges(mesh)),
          normal_(vertex_normals(mesh)) {}

    /// The vertex nearest to p with a normal near to n for which accept(v) holds; −1 = none.
    template <class Accept>
    Index vertex(const Vec3& p, const Vec3& n, Accept accept) const {
        constexpr double facing = 0.2; // least cosine between the normals
        return points_.nearest(p, [&](Vertex v) {
            return leaving_[v] >= 0 && normal_[v].dot(n) > facing && accept(v);
        });
    }

    /// The place on the faces around a vertex that is nearest to p, among those that are accepted.
    template <class Accept>
    std::pair<Index, Vec3> on_faces(const Vec3& p, Vertex v, Accept accept) const {
        std::pair<Index, Vec3> best{-1, mesh_.points[v]};
        visit_star(mesh_, leaving_[v], [&](HalfEdge h) {
            const Face f = face_of(h);
            if (!accept(f))
                return;
            const auto [a, b, c] = mesh_.faces[f];
            const Vec3 q =
                nearest_in_triangle(p, mesh_.points[a], mesh_.points[b], mesh_.points[c]);
            if (best.first < 0 || (q - p).squaredNorm() < (best.second - p).squaredNorm())
                best = {f, q};
        });
        return best;
    }
    const Vec3& normal(Vertex v) const { return normal_[v]; }
    Index leaving(Vertex v) const { return leaving_[v]; }

private:
    const Mesh& mesh_;
    NearestPoints points_;
    std::vector<Index> leaving_;
    std::vector<Vec3> normal_;
};

} // namespace devseg::mesh
