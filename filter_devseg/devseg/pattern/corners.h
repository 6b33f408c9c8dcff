// The vertices of outlines that matter: corners, where seams end between two junctions, and those
// that remain when outlines are simplified.
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005, section 4. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include <vector>

#include "devseg/pattern/seams.h"

namespace devseg::pattern {

/// The chains, cut at their corners. Borders of charts follow the edges of a mesh, so that outlines
/// are ragged: a corner is a place where the lines that fit the outline best in front of it and
/// behind it, over a tenth of the piece's size and some edges, meet at more than `corner_angle`
/// (radians) on either side of the seam, and by more than the raggedness explains. Rounded bends
/// are none, nor are places that are close to sharper corners and to ends. Chains that were made to
/// split pieces stay whole.
std::vector<Chain> cut_at_corners(const std::vector<PatternPiece>& pieces,
                                  const std::vector<Chain>& chains, double corner_angle);

/// Points of a polyline at which it has a corner, ascending, its ends not among them. `sides` are
/// one polyline or two with points in pairs; closed ones repeat their first point, which may be a
/// corner. `reach` (mm) is the length of the stretches that lines are fitted to.
std::vector<Index> find_corners(const std::vector<std::vector<Vec2>>& sides, double reach,
                                double corner_angle);

/// Which points of a polyline stay: the first, the last, and so many between them that those left
/// out lie within `tolerance` of the polyline that remains. `sides` are one polyline or two with
/// points in pairs, which stay or go together. Points go in the order of their cost [JKS05,
/// section 4]: the area of the triangles with their neighbours, on both sides, plus half of the
/// cost of neighbours that went before. A closed polyline (first point = last point) keeps three.
std::vector<Index> collapse_vertices(const std::vector<std::vector<Vec2>>& sides, double tolerance);

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
