// Packing on shelves: the boxes of the charts in rows, from the highest to the lowest. For one
// chart, and for thousands: fast, and good enough for small charts.
#pragma once

#include <vector>

#include "devseg/pack/outline.h"
#include "devseg/pack/pack.h"

namespace devseg::pack {

/// `side`: where the search for the square begins, from below.
std::vector<Placement> pack_on_shelves(const std::vector<Outline>& outlines,
                                       const PackOptions& options, double side, Progress& progress);

} // namespace devseg::pack
