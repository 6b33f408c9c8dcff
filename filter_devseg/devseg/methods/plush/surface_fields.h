// What the placing of seams reads off the surface: conformal factor, its extrema, mean curvature.
//
// References
//   [BGB08] M. Ben-Chen, C. Gotsman, G. Bunin: Conformal Flattening by Curvature Prescription and
//           Metric Scaling. Computer Graphics Forum 27(2), 2008.
//           doi:10.1111/j.1467-8659.2008.01142.x
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "devseg/mesh/mesh.h"

namespace devseg::plush {

/// Neighbours of all vertices: those of v are vertex[begin[v]] … vertex[begin[v + 1] − 1],
/// ascending, with a half-edge between the two in either direction.
struct VertexGraph {
    std::vector<Index> begin;     // #V + 1
    std::vector<Index> vertex;    // 2 #E
    std::vector<Index> half_edge; // 2 #E
};
VertexGraph build_vertex_graph(const Mesh& mesh);

/// Positive semi-definite cotangent Laplacian, #V by #V, and a third of the areas around vertices.
Eigen::SparseMatrix<double> cotangent_laplacian(const Mesh& mesh);
std::vector<double> vertex_areas(const Mesh& mesh);

/// Of all half-edges, internal units.
double mean_edge_length(const Mesh& mesh);

/// φ with L φ = Kᵀ − K [BGB08], K the angle defects and Kᵀ the total curvature spread by area, with
/// mean 0: low at tips, high in saddles and between limbs. #V, no unit.
std::vector<double> conformal_factor(const Mesh& mesh);

/// Vertices whose value is the lowest, or the highest, within two rings, those that stand out most
/// first, at most `count` of them.
std::vector<Index> find_extrema(const VertexGraph& graph, const std::vector<double>& value,
                                Index count);

/// Mean curvature at vertices, positive on convex places, smoothed over a few edges, times the
/// radius of a sphere of the mesh's area: 1 on a sphere. #V, no unit.
std::vector<double> mean_curvature(const Mesh& mesh);

} // namespace devseg::plush
