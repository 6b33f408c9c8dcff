// What the placing of seams reads off the surface: conformal factor, its extrema, mean curvature,
// and how much each bone matters to each vertex.
//
// References
//   [BGB08] M. Ben-Chen, C. Gotsman, G. Bunin: Conformal Flattening by Curvature Prescription and
//           Metric Scaling. Computer Graphics Forum 27(2), 2008.
//           doi:10.1111/j.1467-8659.2008.01142.x
//   [BP07]  I. Baran, J. Popović: Automatic Rigging and Animation of 3D Characters. ACM
//           Transactions on Graphics 26(3), 2007. doi:10.1145/1276377.1276467 (bone heat)
#pragma once

#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"
#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/skeleton.h"

namespace devseg::plush {

/// What all fields are computed with.
struct Laplacian {
    Eigen::SparseMatrix<double> matrix; // #V by #V: of cotangents, positive semi-definite
    std::vector<double> areas;          // #V: a third of the areas around vertices
};
Laplacian make_laplacian(const Mesh& mesh);

/// φ with L φ = Kᵀ − K [BGB08], K the angle defects and Kᵀ the total curvature spread by area, with
/// mean 0: low at tips, high in saddles and between limbs. #V, no unit.
std::vector<double> conformal_factor(const Mesh& mesh, const Laplacian& laplacian);

/// Vertices whose value is the lowest, or the highest, within two rings, those that stand out most
/// first, at most `count` of them.
std::vector<Index> find_extrema(const VertexGraph& graph, const std::vector<double>& value,
                                Index count);

/// Mean curvature at vertices, positive on convex places, smoothed over a few edges, times the
/// radius of a sphere of the mesh's area: 1 on a sphere. #V, no unit.
std::vector<double> mean_curvature(const Mesh& mesh, const Laplacian& laplacian);

/// The weights of the bones, each row adds up to 1: the equilibrium of heat that each vertex takes
/// from its nearest bone, in inverse proportion to the squared distance, and spreads over the
/// surface [BP07]. #V rows of at most `most` pairs (bone, weight), largest first.
using BoneWeights = std::vector<std::vector<std::pair<Index, double>>>;
BoneWeights bone_weights(const Mesh& mesh, const Laplacian& laplacian, const Skeleton& skeleton,
                         const Progress& progress);

/// The direction of the skeleton on the surface, and how much the bones agree on it (0 … 1; 0
/// where bones stand upright on the surface or run all ways).
struct SkeletonDirection {
    Vec3 direction = Vec3::Zero(); // unit, across the normal; or zero
    double agreement = 0.0;
};

/// At an edge between two vertices, where the surface has the unit `normal`. [Plush]'s equations
/// 4 to 6 take the weighted mean of the bones; here they are projected onto the surface first, so
/// that a line along an arm and over its tip follows the arm, and bones have no sign: the direction
/// is the first principal axis of the weighted sum of p pᵀ over the projections p.
SkeletonDirection skeleton_direction(const Skeleton& skeleton, const BoneWeights& weights, Index a,
                                     Index b, const Vec3& normal);

} // namespace devseg::plush
