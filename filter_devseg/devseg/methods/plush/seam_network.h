// The seams of a segmentation as a network: segments between the places where they meet, and paths
// over edges that become some.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"
#include "devseg/mesh/mirror_plane.h"

namespace devseg::plush {

/// Marks of half-edges (3 #F), symmetric: a half-edge and its twin agree.
using SeamMarks = std::vector<std::uint8_t>;

void mark(const Mesh& mesh, HalfEdge half_edge, std::uint8_t value, SeamMarks& seam);
void mark(const Mesh& mesh, const std::vector<Index>& line, std::uint8_t value, SeamMarks& seam);

/// Of marks that may be empty.
inline bool is_marked(const SeamMarks& marks, HalfEdge h) {
    return !marks.empty() && marks[h] != 0;
}
bool any_marked(const SeamMarks& marks, const std::vector<Index>& line);
/// Whether patches end at the edge: a seam, or the mesh's boundary.
inline bool is_border(const Mesh& mesh, const SeamMarks& seam, HalfEdge h) {
    return seam[h] != 0 || mesh.twin[h] < 0;
}
/// 1 for the vertices (#V) on the borders of patches.
std::vector<std::uint8_t> border_vertices(const Mesh& mesh, const SeamMarks& seam);

/// Of all half-edges (3 #F), their mean, and the sum of some; internal units.
std::vector<double> edge_lengths(const Mesh& mesh);
double mean_edge_length(const Mesh& mesh);
double length_of(const Mesh& mesh, const std::vector<Index>& line);

/// A line of seam edges from one end to the next. Ends are the vertices where not exactly two seam
/// edges meet, those on the mesh's boundary, and where material borders begin.
struct SeamSegment {
    std::vector<Index> half_edges; // head to tail, the first side's; the twins are the other side
    bool is_loop = false;          // without any end
    bool is_hard = false;          // a border between materials: it must stay
    double length = 0.0;           // internal units
    double weight = 0.0;           // mean weight of its edges: low where a seam looks natural
};

/// All segments, in the order of their lowest half-edge. `hard` is 3 #F or empty; `weight` is the
/// weight of each half-edge (3 #F, twins agree), or empty: 0.
std::vector<SeamSegment> find_segments(const Mesh& mesh, const SeamMarks& seam,
                                       const SeamMarks& hard = {},
                                       const std::vector<double>& weight = {});

/// Seam edges at each vertex, #V; the mesh's own boundary edges count too.
std::vector<Index> seam_degrees(const Mesh& mesh, const SeamMarks& seam);

/// The patches that hold the given faces, each with its faces in ascending order.
std::vector<std::vector<Index>> patches_of(const Mesh& mesh, const SeamMarks& seam,
                                           const std::vector<Index>& faces);
/// All patches, in the order of their labels.
std::vector<std::vector<Index>> patches_of(const Mesh& mesh, const SeamMarks& seam);
/// The patches on both sides of lines of half-edges.
std::vector<std::vector<Index>> patches_beside(const Mesh& mesh, const SeamMarks& seam,
                                               const std::vector<std::vector<Index>>& lines);

/// The labels of the patches, #F: the components of the faces over edges that are no seam.
mesh::FaceComponents find_patches(const Mesh& mesh, const SeamMarks& seam);

/// Neighbours of all vertices: those of v are vertex[begin[v]] … vertex[begin[v + 1] − 1],
/// ascending, with a half-edge between the two in either direction.
struct VertexGraph {
    std::vector<Index> begin;     // #V + 1
    std::vector<Index> vertex;    // 2 #E
    std::vector<Index> half_edge; // 2 #E
};
VertexGraph build_vertex_graph(const Mesh& mesh);

/// Distances from one vertex over weighted edges, and the way back.
struct PathTree {
    std::vector<double> distance; // #V, infinite where nothing leads
    std::vector<Index> half_edge; // #V: half-edge of the last step, either direction; −1 = none
};

/// From any of the sources. `may_enter` (#V, may be empty) closes vertices; vertices with
/// `is_goal` (#V, may be empty) are reached but not left.
PathTree shortest_paths(const VertexGraph& graph, const std::vector<double>& weight,
                        const std::vector<Index>& sources, const Progress& progress,
                        const std::vector<std::uint8_t>& may_enter = {},
                        const std::vector<std::uint8_t>& is_goal = {});

/// Half-edges from the tree's root to a vertex, the last one first, in either direction.
std::vector<Index> trace_path(const Mesh& mesh, const PathTree& tree, Vertex vertex);

/// Marks the shortest paths between all pairs of the vertices; edges that are seams already count
/// less, so that paths that run side by side become one.
void add_structural_seams(const Mesh& mesh, const VertexGraph& graph,
                          const std::vector<double>& weight, const std::vector<Index>& ends,
                          SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
