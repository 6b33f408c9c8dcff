// Moving one vertex at a time to where the symmetric Dirichlet energy of its faces is least.
#pragma once

#include <array>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg {

/// The faces around one vertex p of a map: of face i the corners are p, from[i] and to[i].
struct VertexStar {
    struct Face {
        Vec2 from, to;
        double area = 0.0;     // of the rest triangle
        double cot_from = 0.0; // of its angles at `from`, at `to` and at p
        double cot_to = 0.0;
        double cot_apex = 0.0;
    };
    std::vector<Face> faces;

    /// Σ A (|J|² + |J⁻¹|²) / 4 over the faces with the vertex at p; infinite where one is flipped.
    double energy(const Vec2& p) const;
};

/// One step of Newton's method with a line search that keeps every face's orientation. The start
/// must be valid. Returns the new position; the energy there is not higher.
Vec2 relax_vertex(const VertexStar& star, const Vec2& start);

/// A point from which all edges of the star have their faces on the positive side: the centroid of
/// the kernel of the polygon around the vertex. Of an open star, where the kernel has no end, it
/// stays within the bounds of the star. Falls back to `hint` where rounding leaves nothing.
Vec2 kernel_point(const VertexStar& star, const Vec2& hint);

} // namespace devseg
