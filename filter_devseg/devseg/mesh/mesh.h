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
#include "devseg/mesh/handles.h"

namespace devseg::mesh {

/// Triangles, and which lie side by side.
struct Connectivity {
    std::vector<Triangle> faces; // #F
    std::vector<HalfEdge> twin;  // 3 #F: the opposite half-edge, −1 on a boundary

    Index face_count() const { return static_cast<Index>(faces.size()); }
    Index half_edge_count() const { return 3 * face_count(); }
    Range<FaceKind> all_faces() const { return {0, face_count()}; }
    Range<HalfEdgeKind> all_half_edges() const { return {0, half_edge_count()}; }

    Vertex origin(HalfEdge h) const { return faces[face_of(h)][corner_of(h)]; }
    Vertex target(HalfEdge h) const { return origin(next(h)); }
    /// The third corner of the face.
    Vertex apex(HalfEdge h) const { return origin(previous(h)); }
    /// The face on the other side, −1 on a boundary.
    Face across(HalfEdge h) const { return twin[h] < 0 ? Face() : face_of(twin[h]); }
    /// The boundary half-edge that goes on from the target of h.
    HalfEdge next_on_boundary(HalfEdge h) const {
        h = next(h);
        while (twin[h] >= 0)
            h = next(twin[h]);
        return h;
    }

    static HalfEdge next(HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static HalfEdge previous(HalfEdge h) { return h % 3 == 0 ? h + 2 : h - 1; }
};

struct Mesh : Connectivity {
    std::vector<Vec3> points;       // #V, in internal units
    std::vector<double> face_areas; // #F, internal units squared
    std::vector<Vec3> face_normals; // #F, unit; faces without area take a neighbour's normal
    std::vector<Vec3> face_centers; // #F, centroids
    Eigen::AlignedBox3d box;        // around the points
    double total_area = 0.0;
    double unit_length = 1.0; // model units per internal unit
    double whole_area = 0.0;  // of the model that this is a part of; 0 = it is no part

    Index vertex_count() const { return static_cast<Index>(points.size()); }
    Range<VertexKind> all_vertices() const { return {0, vertex_count()}; }
    /// What gaps and tolerances in the plane refer to: the same for all parts of a model.
    double model_area() const { return whole_area > 0.0 ? whole_area : total_area; }
    double edge_length(HalfEdge h) const { return (points[target(h)] - points[origin(h)]).norm(); }
    /// Of the box, internal units.
    double diagonal() const { return box.diagonal().norm(); }
};

/// Fills areas, normals, centres, the total area and the box from points and faces.
void compute_face_geometry(Mesh& mesh);

/// One label for each face, 0 … count − 1: the connected components of the faces over edges for
/// which `connected(h)` holds (asked once for each half-edge with a twin).
struct FaceComponents {
    std::vector<Index> label; // #F
    Index count = 0;
};

template <class Connected>
FaceComponents face_components(const Connectivity& mesh, Connected connected) {
    FaceComponents result;
    result.label.assign(mesh.faces.size(), -1);
    std::vector<Index> stack;
    for (const Face start : mesh.all_faces()) {
        if (result.label[start] >= 0)
            continue;
        result.label[start] = result.count;
        stack.push_back(start);
        while (!stack.empty()) {
            const Face f = stack.back();
            stack.pop_back();
            for (const HalfEdge h : half_edges_of(f)) {
                const Face g = mesh.across(h);
                if (g < 0 || result.label[g] >= 0 || !connected(h))
                    continue;
                result.label[g] = result.count;
                stack.push_back(g);
            }
        }
        ++result.count;
    }
    return result;
}

/// Calls visit(h) for the half-edges that leave the origin of `half_edge`, one for each face around
/// it; returns whether the faces go all around, which is false on the boundary.
template <class Visit>
bool visit_star(const std::vector<HalfEdge>& twin, HalfEdge half_edge, Visit visit) {
    HalfEdge leaving = half_edge;
    do {
        visit(leaving);
        leaving = twin[Mesh::previous(leaving)];
    } while (leaving >= 0 && leaving != half_edge);
    if (leaving == half_edge)
        return true;
    for (HalfEdge back = twin[half_edge]; back >= 0; back = twin[Mesh::next(back)])
        visit(Mesh::next(back));
    return false;
}
template <class Visit>
bool visit_star(const Connectivity& mesh, HalfEdge half_edge, Visit visit) {
    return visit_star(mesh.twin, half_edge, visit);
}

} // namespace devseg::mesh

namespace devseg {
using mesh::Mesh;
} // namespace devseg
