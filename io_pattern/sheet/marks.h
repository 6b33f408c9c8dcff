// What is written and drawn into a piece: its name, seam numbers, notches and the grain line.
#pragma once

#include "sheet/sheet_piece.h"

namespace devseg {

/// Adds the marks that the options want; the cut and sew lines must be there.
void add_marks(const Pattern& pattern, const std::vector<Seam>& numbered,
               const ExportOptions& options, SheetPiece& piece);

} // namespace devseg
