// A second search for the fewest pages, which goes on where closing pages (page_search.h) is stuck.
//
// Two kinds of moves take turns. Some pieces are taken out, and each is laid anew where it needs
// the fewest new pages, of all free places: ruin and recreate [SSWD00]; mostly those of a page that
// is hardly covered, which is closed meanwhile. What is no worse than some moves ago is taken
// [BB17]. Or a page is closed, and pieces make room for each other on the pages that are left.
//
// References
//   [SSWD00] G. Schrimpf, J. Schneider, H. Stamm-Wilbrandt, G. Dueck: Record Breaking Optimization
//            Results Using the Ruin and Recreate Principle. J. Comput. Phys. 159, 2000.
//            doi:10.1006/jcph.1999.6413
//   [BB17]   E. K. Burke, Y. Bykov: The Late Acceptance Hill-Climbing Heuristic. European Journal
//   of
//            Operational Research 258, 2017. doi:10.1016/j.ejor.2016.07.012
#pragma once

#include <vector>

#include "sheet/page_board.h"
#include "sheet/page_fine.h"

namespace devseg::sheet {

/// All layouts that several searches find, from empty boards, and from `start` where that is not
/// null; for so much work, in cells that are looked at. The same for any number of threads. Throws
/// Cancelled.
std::vector<CoarseLayout> lay_pieces_anew(const PageProblem& problem,
                                          const std::vector<BoardPiece>& pieces,
                                          const std::vector<pack::ChartPoses>& poses,
                                          const CoarseLayout* start, double work,
                                          Progress& progress);

} // namespace devseg::sheet
