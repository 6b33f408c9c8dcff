// The triangle mesh that every method reads: flat arrays, half-edge adjacency, nothing mutable.
//
// Half-edge h = 3 f + e runs from corner e to corner e + 1 (mod 3) of face f. Worked example, two
// triangles that share the edge (1, 2):
//
//     faces  = {0,1,2}, {2,1,3}          half-edges of face 0: 0 = (0→1), 1 = (1→2), 2 = (2→0)
//     twin   = {-1, 3, -1,  1, -1, -1}   half-edges of face 1: 3 = (2→1), 4 = (1→3), 5 = (3→2)
//
// Invariants: faces are coherently oriented (a half-edge and its twin run in opposite directions),
// an edge has one or two faces, and the faces around a vertex form one fan.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "devseg/base/numbers.h"

namespace devseg::mesh {

struct Mesh {
    std::vector<Vec3> points;       // #V, in internal units
    std::vector<Triangle> faces;    // #F
    std::vector<Index> twin;        // 3 #F: the opposite half-edge, −1 on a boundary
    std::vector<double> face_areas; // #F, internal units squared
    std::vector<Vec3> face_normals; // #F, unit; faces without area take a neighbour's normal
    std::vector<Vec3> face_centers; // #F, centroids
    double total_area = 0.0;
    double unit_length = 1.0; // model units per internal unit

    Index vertex_count() const { return static_cast<Index>(points.size()); }
    Index face_count() const { return static_cast<Index>(faces.size()); }
    Index half_edge_count() const { return 3 * face_count(); }
    Index origin(Index h) const { return faces[at(h / 3)][at(h % 3)]; }
    Index target(Index h) const { return origin(next(h)); }
    double edge_length(Index h) const {
        return (points[at(target(h))] - points[at(origin(h))]).norm();
    }

    static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static Index previous(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
};

/// Fills areas, normals, centres and the total area from points and faces.
void compute_face_geometry(Mesh& mesh);

/// One label for each face, 0 … count − 1: the connected components of the faces over edges for
/// which `connected(h)` holds (asked once for each half-edge with a twin).
struct FaceComponents {
    std::vector<Index> label; // #F
    Index count = 0;
};

template <class Connected>
FaceComponents face_components(const Mesh& mesh, Connected connected) {
    FaceComponents result;
    result.label.assign(mesh.faces.size(), -1);
    std::vector<Index> stack;
    for (Index start = 0; start < mesh.face_count(); ++start) {
        if (result.label[at(start)] >= 0)
            continue;
        result.label[at(start)] = result.count;
        stack.push_back(start);
        while (!stack.empty()) {
            const Index f = stack.back();
            stack.pop_back();
            for (Index h = 3 * f; h < 3 * f + 3; ++h) {
                const Index opposite = mesh.twin[at(h)];
                if (opposite < 0 || result.label[at(opposite / 3)] >= 0 || !connected(h))
                    continue;
                result.label[at(opposite / 3)] = result.count;
                stack.push_back(opposite / 3);
            }
        }
        ++result.count;
    }
    return result;
}

/// Calls visit(h) for the half-edges that leave the origin of `half_edge`, one for each face around
/// it; returns whether the faces go all around, which is false on the boundary.
template <class Visit>
bool visit_star(const std::vector<Index>& twin, Index half_edge, Visit visit) {
    Index leaving = half_edge;
    do {
        visit(leaving);
        leaving = twin[at(Mesh::previous(leaving))];
    } while (leaving >= 0 && leaving != half_edge);
    if (leaving == half_edge)
        return true;
    for (Index back = twin[at(half_edge)]; back >= 0; back = twin[at(Mesh::next(back))])
        visit(Mesh::next(back));
    return false;
}
template <class Visit>
bool visit_star(const Mesh& mesh, Index half_edge, Visit visit) {
    return visit_star(mesh.twin, half_edge, visit);
}

} // namespace devseg::mesh

namespace devseg {
using mesh::Mesh;
} // namespace devseg
