// The search for the fewest pages: one page after the other is closed, and pieces that lay on it
// find room on those that are left.
#pragma once

#include <vector>

#include "sheet/page_grid.h"

namespace devseg::sheet {

/// Where each piece lies, on one board.
struct PageLayout {
    Index columns = 1; // of the sheet
    Index rows = 0;
    Index singles = 0;
    std::vector<pack::ChartCells> images; // of each piece, in the problem's cells
    std::vector<pack::Spot> spots;
    std::vector<Index> page; // −1: a large piece, on several pages of the sheet
};

/// As few pages as counted work finds, of several searches. The same for any number of threads.
/// Throws Cancelled.
PageLayout search_pages(const PageProblem& problem, Progress& progress);

} // namespace devseg::sheet
