// Charts that are too large for the sheet or the cloth, cut in parts.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/base/progress.h"

namespace devseg::pattern {

struct SplitCharts {
    atlas::ChartMap charts;
    std::vector<std::uint8_t> cut; // 3 #F: 1 on both sides of the new cuts
    Index too_large = 0;           // charts of one face that are still larger than allowed
};

/// Cuts every chart whose least box is longer than `longest` (units of `uv`) across its long
/// direction, into as few parts as fit, along the shortest line of mesh edges within the stretch
/// that leaves both parts small enough, until none is too large.
SplitCharts split_large_charts(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts,
                               double longest, Progress& progress);

} // namespace devseg::pattern
