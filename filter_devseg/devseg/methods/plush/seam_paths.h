// Seams that may be: shortest paths between extrema.
#pragma once

#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/surface_fields.h"

namespace devseg::plush {

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
