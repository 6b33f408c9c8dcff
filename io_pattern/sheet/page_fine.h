// What a search has found on coarse cells, brought to the problem's own.
#pragma once

#include <optional>
#include <vector>

#include "sheet/page_first_fit.h"

namespace devseg::sheet {

/// Where pieces lie on a grid of coarse cells.
struct CoarseLayout {
    Index columns = 1;
    Index rows = 0;
    Index singles = 0;
    pack::Layout spots;
    Index goal = 0; // pages, those that are almost empty counted thrice
};

/// Pages, by the cells that pieces cover on each. Those that are almost empty count thrice: one
/// page more is better.
Index goal_of(const PageProblem& problem, const std::vector<Index>& covered, double cell);
Index goal_of(const PageProblem& problem, const PageLayout& layout);

/// Pieces move and turn a little, until they lie apart on the same pages; nothing where they find
/// no room. `coarse`: the images of each piece. The work is counted. Throws Cancelled.
std::optional<PageLayout> refined(const PageProblem& problem,
                                  const std::vector<pack::ChartPoses>& coarse,
                                  const CoarseLayout& found, const Progress& progress);

} // namespace devseg::sheet
