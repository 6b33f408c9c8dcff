// A piece that is its own mirror image, as the half that is cut along a fold of the cloth.
#pragma once

#include "devseg/pattern/same_pieces.h"
#include "sheet/sheet_piece.h"

namespace devseg::sheet {

/// The half at the right of the axis, turned so that the axis is the line x = 0 and `grain` (unit,
/// in the frame of the pattern) points upwards. The closed lines of cut and sew line lead along the
/// fold; marks on the other half are left out.
SheetPiece half_piece(const SheetPiece& whole, const pattern::MirrorAxis& axis, const Vec2& grain);

} // namespace devseg::sheet
