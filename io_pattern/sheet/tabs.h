// Tabs to glue pieces with.
#pragma once

#include <array>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::sheet {

/// Which sides of a seam get tabs. Automatic: one where glue tabs are asked for. Alternating: the
/// stretches of a seam take turns.
enum class TabSides { automatic, one, both, alternating, none };

struct TabOptions {
    double depth = 5.0; // mm
    TabSides sides = TabSides::one;
    bool borders = false; // along open borders of the model as well
};

/// A flap along the edges first … first + count − 1 (modulo their number) of an outline, almost a
/// straight line: from the start of the first edge over both corners to the end of the last. Equal
/// corners make a triangle.
struct GlueTab {
    Index piece = -1;
    Index path = 0; // PatternPiece::path
    Index first = 0;
    Index count = 0;
    std::array<Vec2, 2> corner{Vec2::Zero(), Vec2::Zero()};
    bool on_border = false; // of the model: nothing is glued to it there
};

/// Where a tab comes to lie behind the piece on the other side of the seam.
struct TabShadow {
    Index piece = -1;
    std::vector<Vec2> line; // from the seam over the tab's corners back to it, where the pattern
                            // has the piece
};

struct GlueTabs {
    std::vector<std::vector<GlueTab>> tabs; // of each piece
    std::vector<TabShadow> shadows;         // those that lie within their piece
    Index seams_without = 0;                // seams that have no tab at all: no room on either side
};

/// Each seam is divided into stretches that are almost straight on both sides, and each stretch
/// gets one tab: `depth` mm deep with sides of 45 degrees, less where the outline leaves less
/// room, on the side of the seam where it fits best; a triangle where the stretch is too short for
/// more. No tab overlaps a piece or another tab of the same piece. Stretches with less room than a
/// fifth of the depth get none. With both sides, each gets what it has room for.
GlueTabs make_tabs(const pattern::Pattern& pattern, const TabOptions& options, Progress& progress);

} // namespace devseg::sheet
