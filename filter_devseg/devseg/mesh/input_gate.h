// The one place where a host's mesh becomes a Mesh: checked, cleaned inside, mapped back.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// A mesh as hosts have it: any triangles, possibly non-manifold, unoriented or degenerate.
struct RawMesh {
    std::vector<Vec3> points;    // #V, model units
    std::vector<Triangle> faces; // #F
};

/// A source face that lost its area where its vertices were joined (mesh/empty_edges.h): it lies on
/// an edge of the mesh, or at a vertex.
struct CollapsedFace {
    Index source = -1;
    std::array<HalfEdge, 3> at;     // of its corners: leaves the same vertex, in the stand-in
    std::array<HalfEdge, 3> on;     // of its edges: on the same edge of the mesh
    std::array<HalfEdge, 3> beside; // of its edges: shares the source's edge with it
    std::array<Index, 3> next{-1, -1, -1}; // of its edges: place of the collapsed face that shares
                                           // it, where no face of the mesh does
};                                         // −1 where there is none

/// The checked mesh with the way back to the host's faces ("source faces").
///
/// What is worked around without touching the host's mesh: vertices at the same place are joined
/// where that closes open edges (mesh/weld.h) or an edge joins them (mesh/empty_edges.h), faces
/// that repeat a vertex or another face and parts without area (mesh/empty_parts.h) are left out,
/// edges with more than two faces are cut, vertices where several fans touch are split, faces are
/// oriented coherently, and one-sided surfaces are cut where no coherent orientation exists.
/// Coordinates are moved to the origin and scaled by a power of two, so that neither the position
/// nor the size of a model matters.
struct GatedMesh {
    Mesh mesh;
    Vec3 center = Vec3::Zero();        // model coordinates of the mesh's origin
    std::vector<Index> source_face;    // #F: index of the source face
    std::vector<Index> source_vertex;  // #V: index of the source vertex, the first of those that
                                       // were joined; the parts of one that was split share it
    std::vector<std::uint8_t> flipped; // #F: 1 where the orientation was turned over
    std::vector<std::uint8_t> cut;     // 3 #F: 1 on half-edges whose edge the gate had to cut
    std::vector<Index> stand_in; // #source faces: the face whose results it takes, −1 = none
    std::vector<CollapsedFace> collapsed; // by source face
    std::vector<std::string> notes;       // what was worked around, one sentence each

    /// Source corner of corner k of face f; a turned face swaps its last two corners.
    Index source_corner(Face f, Index k) const { return flipped[f] != 0 && k != 0 ? 3 - k : k; }
    /// Source edge (edge e joins corners e and e + 1) of edge e of face f.
    Index source_edge(Face f, Index e) const { return flipped[f] != 0 ? 2 - e : e; }
    /// Null where the source face has not collapsed.
    const CollapsedFace* find_collapsed(Index source) const;
};

struct GateOptions {
    // Vertices are joined up to this distance, as a share of the model's size (the longest side of
    // its box); 0: those at the same place; below 0: none. Borders that lie on each other and are
    // not joined count as cut.
    double weld = 0.0;
    // Closed surfaces whose faces look inwards are turned over, but for cavities. They are noted in
    // any case.
    bool turn_inside_out = false;
};

/// Throws InvalidMesh where nothing sensible can be done: no faces, an index out of range,
/// coordinates that are not finite, all faces without area; Cancelled.
GatedMesh gate_mesh(const RawMesh& raw, const GateOptions& options = {},
                    const Progress& progress = Progress());

} // namespace devseg::mesh
