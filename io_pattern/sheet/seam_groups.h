// Short seams in a row, that share one number on paper.
#pragma once

#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg {

/// The pattern's seams in their order, where seams shorter than `least` mm that continue one
/// another on both sides are joined to one. Its label names the first and the last: "3-7".
/// Notches stay with the pattern's own seams.
std::vector<Seam> group_seams(const Pattern& pattern, double least);

/// Long enough for a number that can be read.
constexpr double least_numbered_seam = 20.0; // mm

} // namespace devseg
