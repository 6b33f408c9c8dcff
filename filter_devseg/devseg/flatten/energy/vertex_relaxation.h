// Moving one vertex at a time to where the symmetric Dirichlet energy of its faces is least, and
// single faces that a map stretches far more than the rest.
#pragma once

#include <array>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

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
    double steepness = 0.0; // s > 0: the density ψ counts as exp(s (ψ − 1)), so that peaks dominate

    /// Σ A ψ over the faces with the vertex at p, ψ = (|J|² + |J⁻¹|²) / 4, or Σ A exp(s (ψ − 1));
    /// infinite where a face is flipped.
    double energy(const Vec2& p) const;
};

/// A chart's faces with their rest shapes, by reference.
struct StarSource {
    const std::vector<Triangle>& faces;                  // #f
    const std::vector<HalfEdge>& twin;                   // 3 #f
    const std::vector<double>& area;                     // #f
    const std::vector<std::array<double, 3>>& cotangent; // #f: opposite to edge k → k + 1
};

/// Fills `star` with the faces around the origin of a half-edge; uv is #v.
void gather_star(const StarSource& source, const std::vector<Vec2>& uv, HalfEdge leaving,
                 VertexStar& star);

/// One step of Newton's method with a line search that keeps every face's orientation. The start
/// must be valid. Returns the new position; the energy there is not higher.
Vec2 relax_vertex(const VertexStar& star, const Vec2& start);

/// A point from which all edges of the star have their faces on the positive side: the centroid of
/// the kernel of the polygon around the vertex. Of an open star, where the kernel has no end, it
/// stays within the bounds of the star. Falls back to `hint` where rounding leaves nothing.
Vec2 kernel_point(const VertexStar& star, const Vec2& hint);

/// Turns flipped faces back: inner vertices go to where none of the faces around them is flipped.
/// The outline stays. False where faces stay flipped. uv is #v.
bool turn_back(const FlatteningProblem& problem, std::vector<Vec2>& uv);

/// Lowers the largest stretch where few faces stand out: the vertices around them are relaxed under
/// Σ A exp(s (ψ − 1)), with ψ the symmetric Dirichlet density, which shares the stretch out among
/// the faces nearby. No face flips; all other vertices stay. The map stays as it is if that would
/// cost more than a small part of its distortion. With `hold_boundary` the outline stays as well.
/// uv is #v.
void relieve_peaks(const FlatteningProblem& problem, bool hold_boundary, std::vector<Vec2>& uv,
                   const Progress& progress);

/// Brings the vertices around faces that stand out to the least symmetric Dirichlet energy, all
/// together, while the rest of the map stays: for maps that were relaxed vertex by vertex, which
/// leaves needles behind. No face flips, and the energy does not rise.
void settle_peaks(const FlatteningProblem& problem, std::vector<Vec2>& uv,
                  const Progress& progress);

} // namespace devseg::flatten
