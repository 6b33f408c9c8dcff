// Where seams end between two junctions: at the corners of the pieces.
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

} // namespace devseg::pattern
