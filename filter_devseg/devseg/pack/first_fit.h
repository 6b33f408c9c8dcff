// Many charts: each at the lowest free place on a grid, the largest chart first.
#pragma once

#include <vector>

#include "devseg/pack/outline.h"
#include "devseg/pack/pack.h"

namespace devseg::pack {

/// Lays the charts out one after the other, at least options.padding times the square's side apart,
/// in a nearly square box. Several widths are tried; the work grows with the number of charts, and
/// not with its square. `side` is a guess of the square's. Throws Cancelled.
std::vector<Placement> pack_first_fit(const std::vector<Outline>& outlines,
                                      const PackOptions& options, double side, Progress& progress);

} // namespace devseg::pack
