// Curve skeletons of surfaces.
//
// References
//   [TAOZ12] A. Tagliasacchi, I. Alhashim, M. Olson, H. Zhang: Mean Curvature Skeletons. Computer
//            Graphics Forum 31(5), 2012. doi:10.1111/j.1467-8659.2012.03178.x
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
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

/// Of a point from the straight line between two others.
inline double squared_distance(const Vec3& p, const Vec3& from, const Vec3& to) {
    const Vec3 edge = to - from;
    const double t =
        std::clamp((p - from).dot(edge) / std::max(edge.squaredNorm(), 1e-300), 0.0, 1.0);
    return (from + t * edge - p).squaredNorm();
}

/// The skeleton to which the closed surface contracts under mean curvature flow [TAOZ12], its
/// curves simplified to bones; component by component, and empty where the surface has a boundary,
/// or none is found. Runs on a coarse version of large surfaces.
Skeleton extract_skeleton(const Mesh& mesh, const Progress& progress);

/// Reads joints and bones: lines "v X Y Z" and "l I J …" as in OBJ files (joints count from 1), in
/// model units. Throws InvalidParameter naming the line that was not understood, and FileError
/// where the file cannot be read.
Skeleton read_skeleton(const std::string& path, const std::function<Vec3(const Vec3&)>& to_mesh);

} // namespace devseg::plush
