// What surrounds a piece: seam allowance, or tabs to glue.
#pragma once

#include <algorithm>
#include <vector>

#include "devseg/base/progress.h"
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
        : seams(along_seams), darts(along_seams), hems(along_hems), hole_hems(around_holes) {}

    double largest() const { return std::max({seams, darts, hems}); }

    double seams;
    double darts; // seams that end inside of a piece
    double hems;
    double hole_hems;
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

/// A flap along the edges first … first + count − 1 (modulo their number) of an outline, almost a
/// straight line: from the start of the first edge over both corners to the end of the last.
struct GlueTab {
    Index piece = -1;
    Index path = 0; // PatternPiece::path
    Index first = 0;
    Index count = 0;
    std::array<Vec2, 2> corner{Vec2::Zero(), Vec2::Zero()};
};

struct GlueTabs {
    std::vector<std::vector<GlueTab>> tabs; // of each piece
    Index seams_without = 0;                // seams that have no tab at all: no room on either side
};

/// Each seam is divided into stretches that are almost straight on both sides, and each stretch
/// gets one tab: `depth` mm deep with sides of 45 degrees, less where the outline leaves less
/// room, on the side of the seam where it fits best. No tab overlaps a piece or another tab of the
/// same piece. Stretches with less room than a fifth of the depth on both sides get none.
GlueTabs make_tabs(const pattern::Pattern& pattern, double depth, Progress& progress);

} // namespace devseg::sheet
