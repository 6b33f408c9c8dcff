// The search for the fewest pages: one page after the other is closed, and pieces that lay on it
// find room on those that are left.
#pragma once

#include "sheet/page_first_fit.h"

namespace devseg::sheet {

/// As few pages as counted work finds, of several searches. The same for any number of threads.
/// Throws Cancelled.
PageLayout search_pages(const PageProblem& problem, Progress& progress);

} // namespace devseg::sheet
