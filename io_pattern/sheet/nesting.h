// Places for pieces on sheets of a given size, as they are drawn: with allowances and tabs.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pack/pack.h"
#include "sheet/sheet_piece.h"

namespace devseg::sheet {

struct NestingOptions {
    double width = 0.0;      // mm
    double height = 0.0;     // mm; 0 = one sheet that is as high as it needs to be
    double gap = 0.0;        // mm, least distance of two pieces
    bool keep_grain = false; // grain lines upright; otherwise pieces are turned as they fit
};

struct Nesting {
    std::vector<pack::Placement>
        placements;           // one for each piece; the sheet's lower left is the origin
    std::vector<Index> sheet; // −1: larger than a sheet
    Index sheet_count = 0;
};

/// Piece by piece, the largest first, each at the lowest free place of the first sheet that has
/// one, then the leftmost, in the best of its four turns. On a grid of conservative images.
Nesting nest_pieces(const std::vector<const SheetPiece*>& pieces, const NestingOptions& options,
                    Progress& progress);

} // namespace devseg::sheet
