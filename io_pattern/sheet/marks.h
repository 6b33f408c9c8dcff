// What is drawn into a piece beside its outlines: notches and the grain line.
#pragma once

#include "sheet/sheet_piece.h"

namespace devseg::sheet {

/// A place on an outline.
struct OutlinePlace {
    Vec2 position = Vec2::Zero();
    Vec2 direction = Vec2::UnitX(); // along the outline, the piece on its left
};

/// The place at this distance from the seam's start on one side of it.
OutlinePlace place_on(const pattern::PiecePath& path, const pattern::SeamSide& side,
                      double distance);

/// Adds the notches of the piece, where the pattern has it; the cut and sew lines must be there.
void add_notches(const pattern::Pattern& pattern, const ExportOptions& options, SheetPiece& piece);

/// Adds the arrow along the threads, where it is long enough to be of use.
void add_grain(const pattern::PatternPiece& piece, SheetPiece& result);

} // namespace devseg::sheet
