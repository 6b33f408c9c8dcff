// Pieces → pages: as few as a fixed effort finds.
#pragma once

#include <vector>

#include "sheet/layout.h"
#include "sheet/page_cover.h"

namespace devseg::sheet {

struct PageNesting {
    std::vector<pack::Placement> placements; // one for each piece; the sheet's lower left corner,
                                             // margins included, is the origin
    std::vector<Index> sheet;                // one for each piece
    std::vector<PatternSheet> sheets;        // those of several pages first, the emptiest last
};

/// Pieces that fit on a page lie on one. Larger ones lie on sheets of several pages that share
/// strips; others fill what they leave free, clear of the strips. One page after the other is
/// closed (page_search.h). No piece touches the border of the printable area of a page that it fits
/// on. The work is counted, not timed. Throws InvalidParameter where a piece is larger than a page
/// that it may not leave (`tiling`), and Cancelled. Pieces are turned as they fit: paper has no
/// grain, and the arrow on a piece turns with it.
PageNesting nest_on_pages(const std::vector<SheetPiece>& pieces, const PageFormat& page,
                          bool tiling, Progress& progress);

/// A part of a sheet that the same pages show (page_cover.h), counted from below and from the left.
/// Millimetres, the sheet's lower left is the origin.
Eigen::AlignedBox2d part_box(const PatternSheet& sheet, const PageFormat& page, Index part_column,
                             Index part_row);

} // namespace devseg::sheet
