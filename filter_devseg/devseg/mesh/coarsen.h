// Coarser versions of a surface by half-edge collapses, and the way back, one vertex at a time.
//
// References
//   [GH97] M. Garland, P. Heckbert: Surface Simplification Using Quadric Error Metrics. SIGGRAPH
//          1997. doi:10.1145/258734.258849
//   [H96]  H. Hoppe: Progressive Meshes. SIGGRAPH 1996. doi:10.1145/237170.237216
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// A surface with a part of its vertices removed. A collapse takes the two faces beside an edge out
/// (one on a boundary) and gives the other faces of the removed vertex to the kept one, so that
/// faces and half-edges keep their numbers, and a removed face keeps the corners and twins it had.
struct CoarseSurface : Connectivity {
    std::vector<std::uint8_t> alive; // #F
    std::vector<Index> collapses;    // half-edges, removed → kept vertex, in their order
    std::vector<std::size_t> rounds; // number of collapses at the end of each round
    // 3 #F, where lines are kept: of half-edges on one, the number of the coarse edge that they
    // became or are part of (a half-edge of the fine mesh); −1 for others. Else empty.
    std::vector<Index> line;
    Index alive_faces = 0;
};

/// A coarse version of a mesh, and the way back.
struct CoarseMesh {
    Mesh mesh;                 // the faces that are alive
    std::vector<Index> face;   // #f of `mesh`: number in the fine mesh
    std::vector<Index> vertex; // #v of `mesh`: number in the fine mesh
    CoarseSurface surface;     // in the numbers of the fine mesh
};

/// Removes vertices, those first that change the surface least [GH97], until at most `target_faces`
/// are left, or no vertex can go. The topology stays; boundary vertices move along the boundary
/// only. A round removes vertices that are not neighbours of each other.
CoarseMesh coarsen(const Mesh& fine, Index target_faces, const Progress& progress);

/// The same with all cores; not from within a task of parallel_for.
CoarseMesh coarsen_in_parallel(const Mesh& fine, Index target_faces, Progress& progress);

/// The same for a surface with lines on it: edges that are marked in `lines` (3 #F, symmetric) are
/// joined to longer ones, from vertex to vertex of theirs, and stay lines. Ends, branches and the
/// vertices that are marked in `fixed` (#V) stay. All regions between lines stay, too.
CoarseMesh coarsen_between_lines(const Mesh& fine, Index target_faces,
                                 const std::vector<std::uint8_t>& lines,
                                 const std::vector<std::uint8_t>& fixed, Progress& progress);

/// Undoes the last collapse; returns its half-edge, which leaves the vertex that is back.
HalfEdge undo_collapse(CoarseSurface& surface);

CoarseMesh extract_coarse_mesh(const Mesh& fine, CoarseSurface surface);

/// Labels of the coarse mesh's faces → labels of all faces (#F), by undoing all collapses. The two
/// faces that come back with a vertex take the label of a neighbour each, so that regions stay
/// connected; where they may choose, borders stay short.
std::vector<Index> refine_labels(const Mesh& fine, const CoarseMesh& coarse,
                                 const std::vector<Index>& label, const Progress& progress);

} // namespace devseg::mesh
