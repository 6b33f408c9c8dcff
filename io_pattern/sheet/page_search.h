// The search for the fewest pages.
//
// Two kinds of moves take turns. Some pieces are taken out, and each is laid anew where it needs
// the fewest new pages, of all free places (ruin and recreate); mostly those of a page that is
// hardly covered, which is closed meanwhile. Or a page is closed and pieces make room for each
// other on the pages that are left (pack/separation.h).
//
// References
//   [SSWD00] G. Schrimpf, J. Schneider, H. Stamm-Wilbrandt, G. Dueck: Record Breaking Optimization
//            Results Using the Ruin and Recreate Principle. J. Comput. Phys. 159, 2000.
//            doi:10.1006/jcph.1999.6413
//   [BB17]   E. K. Burke, Y. Bykov: The Late Acceptance Hill-Climbing Heuristic. European Journal
//   of
//            Operational Research 258, 2017. doi:10.1016/j.ejor.2016.07.012
#pragma once

#include "sheet/page_first_fit.h"

namespace devseg::sheet {

/// As few pages as counted work finds, of several searches. The same for any number of threads.
/// Throws Cancelled.
PageLayout search_pages(const PageProblem& problem, Progress& progress);

} // namespace devseg::sheet
