// A marker: all pieces with their copies on a roll of cloth, as short as a fixed effort finds.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "sheet/layout.h"

namespace devseg::sheet {

/// Lays the layout's pieces, one for each of the pattern, on a sheet for each of the pattern's
/// fabrics: the cloth, its length upwards, or the half of it that is seen when it is folded (the
/// fold at the left). Pieces lie
/// along the grain, upwards or downwards, or all upwards with a nap; as they like where the grain
/// is free. On folded cloth a piece and its mirror image are cut at once, and so are two pieces
/// that are their own mirror images; such a piece that is alone lies as a half along the fold. What
/// is left is cut from the upper layer alone, with a note.
///
/// Throws InvalidParameter for pieces that are wider than the cloth, Cancelled.
void lay_out_marker(const pattern::Pattern& pattern, const ExportOptions& options,
                    PatternLayout& layout, Progress& progress);

/// Selvedges, fold and size of each cloth; `sheets`: where its sheet lies.
writers::DrawingLayer fabric_layer(const PatternLayout& layout, const std::vector<Vec2>& sheets);

} // namespace devseg::sheet
