// Glue tabs: flaps along one side of each seam, under the other side when the model is glued.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::sheet {

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
