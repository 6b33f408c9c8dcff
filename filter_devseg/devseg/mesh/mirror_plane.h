// The plane in which a surface is nearly its own mirror image.
#pragma once

#include <optional>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

struct MirrorPlane {
    Vec3 normal = Vec3::UnitX(); // unit
    double offset = 0.0;         // of the plane's points along the normal, internal units
    double deviation = 0.0;      // distance of the mirror image that 9 of 10 points keep / diagonal

    double height(const Vec3& p) const { return normal.dot(p) - offset; }
    Vec3 reflect(const Vec3& p) const { return p - 2.0 * height(p) * normal; }
};

/// The best plane that is found from the principal axes and halfway between them, by fitting to
/// the mirror image; nothing where more than a tenth of the surface is farther from its mirror
/// image than `tolerance` times the diagonal.
std::optional<MirrorPlane> find_mirror_plane(const Mesh& mesh, double tolerance,
                                             Progress& progress);

} // namespace devseg::mesh
