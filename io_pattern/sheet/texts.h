// What is written into the pieces: their names and the numbers of their seams.
#pragma once

#include <string>
#include <vector>

#include "sheet/sheet_piece.h"

namespace devseg::sheet {

/// What could not be written in a size that can be read.
struct LeftOut {
    std::vector<Index> seams;  // positions in Pattern::seams
    std::vector<Index> pieces; // positions in Pattern::pieces
};

/// Writes names and seam numbers, as the options want them, into pieces that lie in their places.
/// Texts are upright, 2.5 mm high at least, and touch neither lines nor each other; where there is
/// no room for that, they may cross folds and notches. A number stands beside its seam, inside the
/// piece or on the allowance or tab, or at the end of a line that leads to it. Every seam gets its
/// number on both sides or on none.
LeftOut add_texts(const pattern::Pattern& pattern, const ExportOptions& options,
                  std::vector<SheetPiece>& pieces);

} // namespace devseg::sheet
