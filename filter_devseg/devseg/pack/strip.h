// Packing outlines on a strip of fixed width, as short as a fixed effort finds: a marker on cloth.
//
// As in nesting (see nest.h) charts may overlap and are separated by guided local search, on a
// coarse and then on a fine grid; only the strip's length shrinks. At last the outlines themselves
// are pushed together.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pack/outline.h"
#include "devseg/pack/pack.h"

namespace devseg::pack {

struct StripItem {
    Outline outline;
    std::vector<double> angles; // radians; none: any
    bool at_left = false;       // its least x stays at the left side: it lies on a fold
};

struct StripOptions {
    double width = 0.0;  // of the strip, in the items' units; along x
    double gap = 0.0;    // least distance of two items
    double effort = 1.0; // times the usual one
};

struct StripResult {
    std::vector<Placement> placements; // rotations of the items' angles, within [0, width]
    double length = 0.0;               // from y = 0 on
};

/// Items must fit: in one of their angles they are no wider than the strip. The same result for any
/// number of threads. Throws Cancelled.
StripResult pack_strip(const std::vector<StripItem>& items, const StripOptions& options,
                       Progress& progress);

/// The least width of the item in any of its angles; of eight around where any will do.
double least_width(const StripItem& item);

} // namespace devseg::pack
