// Pieces that are nearly alike made alike, so that one template serves for all of them.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// Pieces whose outlines, as they are or mirrored, are nowhere farther apart than `tolerance_mm`
/// (and a fixed share of their size) all get the mean of their outlines; so do pieces that are as
/// near to their own mirror image, with that. Points of outlines that belong together are found in
/// the order in which they follow each other, so that both sides of a dart stay apart. Pieces keep
/// their place, and their outlines where the mean would cross itself. Returns the number of pieces
/// that changed. The pieces are measured.
Index make_alike(std::vector<PatternPiece>& pieces, double tolerance_mm, const Progress& progress);

} // namespace devseg::pattern
