// Weights of edges as seams, and the seams that may be: shortest paths between extrema.
#pragma once

#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/skeleton.h"
#include "devseg/methods/plush/surface_fields.h"

namespace devseg::plush {

/// Exponents of the three terms of an edge's weight, no unit.
struct SeamWeightOptions {
    double geodesic = 0.3;  // α
    double skeleton = 0.3;  // β
    double curvature = 0.8; // γ
};

/// w = w_g^α w_s^β w_c^γ for each half-edge (3 #F): w_g the length over the longest edge, w_s low
/// along the skeleton, w_c low where the mean curvature (#V) is high. 0 < w ≤ 1. Without a skeleton
/// w_s is 1. Beyond the paper, w is several times lower where seams look natural, which `straying`
/// tells.
struct SeamWeights {
    std::vector<double> weight; // 3 #F
    std::vector<double> stray;  // 3 #F, 0 … 1
};
SeamWeights seam_weights(const Mesh& mesh, const SeamWeightOptions& options,
                         const std::vector<double>& curvature, const Skeleton& skeleton,
                         const BoneWeights& bones, const Progress& progress);

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
