// Outlines as smooth curves.
//
// References
//   P. J. Schneider: An Algorithm for Automatically Fitting Digitized Curves. In: Graphics Gems,
//   Academic Press, 1990: least squares, tangents kept, the worst place becomes a joint.
#pragma once

#include <vector>

#include "devseg/pattern/seams.h"

namespace devseg::pattern {

/// Fills PiecePath::curves of all outlines: between the ends of chains, cubic Bézier curves with
/// common tangents at their joints, within `tolerance` mm of the outline, and lines where it is
/// straight. All joints are points of the outline, and every curve is as long as the edges it
/// stands for. A tolerance of 0 gives a line for each edge.
void fit_curves(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                double tolerance);

/// The curves along a polyline that has at least two different points.
std::vector<OutlineCurve> fit_polyline(const std::vector<Vec2>& points, double tolerance);

/// The same around a closed polygon, which has corners where it turns by more than `corner_angle`
/// (radians). The curves follow one another from the first corner on.
std::vector<OutlineCurve> fit_ring(const std::vector<Vec2>& ring, double corner_angle,
                                   double tolerance);

/// Points along closed curves whose polygon leaves them by `sagitta` at most.
std::vector<Vec2> flatten_curves(const std::vector<OutlineCurve>& curves, double sagitta);

} // namespace devseg::pattern
