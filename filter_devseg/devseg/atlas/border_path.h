// Short paths to the border of a chart, for cuts that open it.
#pragma once

#include "devseg/atlas/charts.h"

namespace devseg::atlas {

/// Factor of an edge's length: 1 on a smooth surface, down to 0.1 on a right-angled crease, where
/// a cut is not seen and does not cost shape.
double crease_factor(const Mesh& mesh, HalfEdge half_edge);

/// What it costs to cut an edge inside a chart: its length, and ten times that between two faces of
/// one plane, which a person would cut around.
double cut_cost(const Mesh& mesh, HalfEdge half_edge);

/// The half-edges of the shortest path within the faces from a vertex to their border or to a cut;
/// creases count less, and edges within a plane more. Half-edges that `uncut` marks (3 #F, or
/// empty) are taken only where there is no other way. Empty where the vertex is on the border, or
/// not among the faces.
std::vector<Index> path_to_border(const Mesh& mesh, const std::vector<Index>& faces,
                                  const std::vector<std::uint8_t>& seam, Vertex vertex,
                                  const std::vector<std::uint8_t>& uncut = {});

/// Marks the half-edges and their twins as cuts.
void mark_cuts(const Mesh& mesh, const std::vector<Index>& half_edges,
               std::vector<std::uint8_t>& seam);

} // namespace devseg::atlas
