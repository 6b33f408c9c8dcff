// What surrounds a piece that is sewn: the seam allowance.
#pragma once

#include <algorithm>
#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg::sheet {

/// Convex corners of the cut line: pointed, up to twice the width away from the corner; cut off
/// straight; or rounded. Concave corners are always trimmed to where the two sides meet.
enum class CornerStyle { miter, bevel, round };

/// Widths in mm along seams, darts and hems, the open borders of the model: those around holes,
/// such as drilled ones, may have none.
struct AllowanceWidths {
    AllowanceWidths(double everywhere) : AllowanceWidths(everywhere, everywhere) {}
    AllowanceWidths(double along_seams, double along_hems)
        : AllowanceWidths(along_seams, along_hems, along_hems) {}
    AllowanceWidths(double along_seams, double along_hems, double around_holes)
        : seams(along_seams), darts(along_seams), zips(along_seams), hems(along_hems),
          hole_hems(around_holes) {}

    double largest() const { return std::max({seams, darts, zips, hems}); }
    double of(const pattern::OutlineSeam& edge, bool in_hole) const;

    double seams;
    double darts; // seams that end inside of a piece
    double zips;  // seams that get a zip
    double hems;
    double hole_hems;
    std::vector<Index> zip_seams; // positions in Pattern::seams
};

/// The cut lines of the piece, outer one first: closed, counterclockwise around the piece and
/// clockwise around its holes. Darts narrower than twice the width are covered, and so are holes.
/// Where the width changes, pointed corners are where both lines meet; on a smooth outline the cut
/// line steps from one width to the other. Edges that say nothing (PiecePath::edges) are seams.
std::vector<std::vector<Vec2>> add_allowance(const pattern::PatternPiece& piece,
                                             const AllowanceWidths& widths, CornerStyle corners);

/// Closed rings, the outer one first, moved away from the piece by `distance` (mm): the outer one
/// outwards, holes inwards, where they may vanish. Corners stay pointed, as those of allowances.
std::vector<std::vector<Vec2>> grown_rings(const std::vector<std::vector<Vec2>>& rings,
                                           double distance);

} // namespace devseg::sheet
