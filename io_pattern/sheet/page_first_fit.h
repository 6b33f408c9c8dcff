// Pieces on pages, one after the other.
#pragma once

#include <array>
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

/// Columns of pages that the widest of the large pieces needs, and those of a square sheet that
/// pieces cover by this share.
std::array<Index, 2> columns_of(const PageProblem& problem, double covered);

/// Each piece at the lowest free place, the largest first, on a sheet of so many columns. Throws
/// Cancelled.
PageLayout first_fit(const PageProblem& problem, Index columns, const Progress& progress);

} // namespace devseg::sheet
