// The search for the fewest pages: pieces are taken out and laid anew, again and again.
#pragma once

#include <vector>

#include "sheet/page_sheet.h"

namespace devseg::sheet {

/// Where each piece lies.
struct Filling {
    std::vector<PageSheet> sheets;
    std::vector<Index> sheet; // of each piece
    std::vector<pack::Spot> spot;
};

/// Pages, and those of them that are hardly worth the paper. A single one may be the last page.
struct PageCount {
    Index pages = 0;
    Index almost_empty = 0;
};
PageCount count_pages(const PageProblem& problem, const Filling& filling);

/// As few pages as counted work finds, of several searches. The same for any number of threads.
/// Throws Cancelled.
Filling search_pages(const PageProblem& problem, Progress& progress);

} // namespace devseg::sheet
