// Where a stuffed solid stays open until the end: on the seam that is seen least.
#pragma once

#include "devseg/assembly/assembly.h"
#include "devseg/assembly/sections.h"

namespace devseg::assembly {

/// One opening for each closed component, of 40 to 80 mm along one seam, on the stretch that is
/// seen least; the whole of the longest seam where none is that long. Components that are one piece
/// without a seam have none.
std::vector<Opening> find_openings(const pattern::Pattern& pattern, const PieceGraph& graph,
                                   const Progress& progress);

} // namespace devseg::assembly
