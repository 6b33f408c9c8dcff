// Both sides of each seam made equally long, without changing the pieces more than needed.
#pragma once

#include <string>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/seams.h"

namespace devseg::pattern {

/// Gives the edges of seams whose sides differ by more than half of what sewing bears (0.2 % and
/// 0.5 mm) one length on both sides: that on the model where one side has it, as LPFB makes them,
/// and the mean of both sides otherwise, which strains the pieces least. Closes the outlines again
/// with angles as near as possible to those they had, as LPFB does. Outlines that would cross
/// themselves for that stay as they are, and the other side follows them. Chains must have the
/// same number of edges on both sides. Returns the number of pieces that were changed.
Index match_sides(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                  const Progress& progress);

/// Whether the two sides of a seam differ by less than sewing bears: 0.2 % and 0.5 mm.
bool sides_agree(double length_a, double length_b);

} // namespace devseg::pattern
