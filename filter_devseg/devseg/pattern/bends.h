// Pieces of thick material: how much shorter they are where they bend.
//
// The mesh is the outer side of the finished object, and the material lies inside it. A bend keeps
// the length of its neutral line, which lies at a share K of the thickness from the bend's inner
// side. Bends of the mesh that are sharp get the inner radius R; what is finely faceted has its
// radius already.
//
// References
//   DIN 6935:2011: flat lengths of bent sheets: bend allowance θ (R + K T), and setback
//   (R + T) tan(θ / 2) on each leg.
#pragma once

#include "devseg/atlas/charts.h"
#include "devseg/pattern/pattern.h"
#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

struct Bend {
    double thickness = 0.0; // mm
    double radius = 0.0;    // mm, of sharp bends, on their inner side
    double k_factor = 0.5;

    bool changes_lengths() const { return thickness > 0.0 || radius > 0.0; }

    /// How much shorter the piece is across a sharp bend by this angle (radians between the
    /// normals, positive = convex) than its two legs on the mesh; below 0: longer. mm.
    double sharp_deduction(double angle) const;
    /// The same of a bend between two facets of a smooth one.
    double smooth_deduction(double angle) const;
};

/// From the options, and from the material where they leave values open.
Bend find_bend(const PatternOptions& options, const std::optional<material::Material>& material);

/// Moves the outlines of the pattern's pieces. Flat parts of a piece keep their shapes and move
/// towards its largest one. Pieces whose bends contradict each other, as around corners and on
/// doubly curved surfaces, stay as they are, and a note counts them. `mm`: length of the mesh's
/// internal unit; bends that are sharper than `fold_angle` (radians) are sharp.
void compensate_bends(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv,
                      const Bend& bend, double fold_angle, Pattern& pattern);

} // namespace devseg::pattern
