// Several sizes of one model on the same sheets: graded by scale, drawn over each other.
#pragma once

#include <string>
#include <vector>

#include "devseg/base/progress.h"
#include "sheet/layout.h"

namespace devseg::sheet {

/// "200,250,300": heights of the finished model in mm, ascending; empty for an empty text. Throws
/// InvalidParameter for others, for sizes that are equal, and for more than 12.
std::vector<double> read_sizes(const std::string& text);

/// Adds all sizes but the largest one, in which the layout is, to it: each piece lies on its large
/// one with the same place of its name, with an allowance as wide. Throws InvalidParameter where a
/// size has other pieces, Cancelled.
void add_sizes(const Mesh& mesh, const CornerUv& uv, const pattern::Pattern& largest,
               const ExportOptions& options, PatternLayout& layout, Progress& progress);

/// A layer for each size, with cut lines and notches. `sheets`: where the sheets lie.
std::vector<writers::DrawingLayer> size_layers(const PatternLayout& layout,
                                               const std::vector<Vec2>& sheets, NotchKind kind);

} // namespace devseg::sheet
