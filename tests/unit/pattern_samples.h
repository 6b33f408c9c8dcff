// Meshes with texture coordinates that have what pattern making is about.
#pragma once

#include <functional>

#include "devseg/declare/filter.h"
#include "devseg/pattern/pieces.h"

namespace devseg::samples {

/// Faces with texture coordinates at their corners, put together part by part.
class Cloth {
public:
    using Place = std::function<Vec2(const Vec3& corner, const Vec3& middle_of_face)>;

    /// Adds a mesh whose texture coordinates are `place` of each corner.
    void add(const mesh::RawMesh& part, const Place& place);

    const declare::HostMesh& host() const { return host_; }
    Mesh mesh() const;
    CornerUv uv() const; // of mesh()
    pattern::Pattern pattern(const pattern::PatternOptions& options = {}) const;

private:
    declare::HostMesh host_;
};

/// Flat on the table: x and y of a point.
Vec2 flat(const Vec3& p);

/// A grid of 8 × 8 cells of side 10 in the plane, with its corners in the texture where they are.
/// Cells right of `seam_x` are 5 to the right in the texture: two pieces with one seam.
Cloth two_pieces(double seam_x = 40.0);

/// The same grid with a dart: from the middle of the right border to the centre, open at an angle
/// in degrees.
Cloth with_dart(double angle);

/// What optimisation finds to do: a dart, a small chart beside a large one on cloth that is not
/// quite flat, and a strip that runs over itself in the texture.
Cloth unfinished();

/// The grid with a dart, two pieces that are nearly the same, and a ring.
Cloth nearly_equal();

} // namespace devseg::samples
