// A mesh in its own frame, so that results do not depend on how a model is turned or moved.
#pragma once

#include <Eigen/Core>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// The principal axes of a surface about its centre, and its size.
struct CanonicalFrame {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity(); // rows, right-handed, longest first
    Vec3 center = Vec3::Zero();
    double unit = 1.0;       // internal units of the mesh: the root of its area
    bool is_identity = true; // points stay as they are

    /// In units of the frame, rounded to a grid of 2⁻²⁴, as fine as single precision: points that
    /// are turned, moved and scaled with the surface are the same to the last bit, but for a
    /// coordinate that happens to lie in the middle of two grid points.
    Vec3 to_frame(const Vec3& p) const;
};

/// Each axis points to where the surface reaches farther (the sign of its third moment). Faces
/// count up to a tenth more or less by their numbers, so that spheres, cubes and mirror images have
/// one frame, too. The identity where the grid would take more than a hundredth of the area away:
/// needles.
CanonicalFrame canonical_frame(const Mesh& mesh, const Progress& progress);

/// The mesh with all points in the frame.
Mesh in_frame(const Mesh& mesh, const CanonicalFrame& frame, const Progress& progress);

} // namespace devseg::mesh
