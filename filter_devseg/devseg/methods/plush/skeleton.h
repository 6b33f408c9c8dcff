// Curve skeletons of surfaces, and how much each bone matters to each vertex.
//
// References
//   [TAOZ12] A. Tagliasacchi, I. Alhashim, M. Olson, H. Zhang: Mean Curvature Skeletons. Computer
//            Graphics Forum 31(5), 2012. doi:10.1111/j.1467-8659.2012.03178.x
//   [BP07]   I. Baran, J. Popović: Automatic Rigging and Animation of 3D Characters. ACM
//            Transactions on Graphics 26(3), 2007. doi:10.1145/1276377.1276467 (bone heat)
#pragma once

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::plush {

/// Straight bones between joints, in internal units of the mesh.
struct Skeleton {
    std::vector<Vec3> joints;
    std::vector<std::array<Index, 2>> bones; // two different joints each

    bool empty() const { return bones.empty(); }
};

/// The skeleton to which the closed surface contracts under mean curvature flow [TAOZ12], its
/// curves simplified to bones; component by component, and empty where the surface has a boundary,
/// or none is found. Runs on a coarse version of large surfaces.
Skeleton extract_skeleton(const Mesh& mesh, const Progress& progress);

/// Reads joints and bones: lines "v X Y Z" and "l I J …" as in OBJ files (joints count from 1), in
/// model units. Throws InvalidParameter naming the line that was not understood, and FileError
/// where the file cannot be read.
Skeleton read_skeleton(const std::string& path, const std::function<Vec3(const Vec3&)>& to_mesh);

/// The weights of the bones, each row adds up to 1: the equilibrium of heat that each vertex takes
/// from its nearest bone, in inverse proportion to the squared distance, and spreads over the
/// surface [BP07]. #V rows of at most `most` pairs (bone, weight), largest first.
using BoneWeights = std::vector<std::vector<std::pair<Index, double>>>;
BoneWeights bone_weights(const Mesh& mesh, const Skeleton& skeleton, const Progress& progress);

/// The direction of the skeleton on the surface, and how much the bones agree on it (0 … 1; 0
/// where bones stand upright on the surface or run all ways).
struct SkeletonDirection {
    Vec3 direction = Vec3::Zero(); // unit, across the normal; or zero
    double agreement = 0.0;
};

/// At an edge between two vertices, where the surface has the unit `normal`. The paper's equations
/// 4 to 6 take the weighted mean of the bones; here they are projected onto the surface first, so
/// that a line along an arm and over its tip follows the arm, and bones have no sign: the direction
/// is the first principal axis of the weighted sum of p pᵀ over the projections p.
SkeletonDirection skeleton_direction(const Skeleton& skeleton, const BoneWeights& weights, Index a,
                                     Index b, const Vec3& normal);

} // namespace devseg::plush
