// Simple outlines: vertices between the ends of chains are left out on both sides at once.
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005, section 4. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include <vector>

#include "devseg/pattern/seams.h"

namespace devseg::pattern {

/// Which points of a polyline stay: the first, the last, and so many between them that those left
/// out lie within `tolerance` of the polyline that remains. `sides` are one polyline or two with
/// points in pairs, which stay or go together. Points go in the order of their cost [JKS05,
/// section 4]: the area of the triangles with their neighbours, on both sides, plus half of the
/// cost of neighbours that went before. A closed polyline (first point = last point) keeps three.
std::vector<Index> collapse_vertices(const std::vector<std::vector<Vec2>>& sides, double tolerance);

/// The points of a chain, from its start: one polyline for each of its sides. Closed chains repeat
/// their first point.
std::vector<std::vector<Vec2>> points_of(const std::vector<PatternPiece>& pieces,
                                         const Chain& chain);

/// The square root of the area of the smaller outline that the chain lies on, mm.
double size_of(const std::vector<PatternPiece>& pieces, const Chain& chain);

/// Marks the ends of chains at which an outline turns by more than `corner_angle` (radians).
void mark_corners(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                  double corner_angle);

/// Leaves vertices out of all outlines, within `tolerance` mm for outlines of 100 mm (the square
/// root of the area) and above, and in proportion for smaller ones. An outline that would cross
/// itself for that keeps all of them.
void simplify_outlines(std::vector<PatternPiece>& pieces, std::vector<Chain>& chains,
                       double tolerance);

/// Whether two edges of the piece's outlines cross in their insides, and all their ends are farther
/// than `depth` mm from the other edge.
bool crosses_itself(const PatternPiece& piece, double depth = 0.0);

} // namespace devseg::pattern
