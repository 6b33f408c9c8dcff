// Notches: marks on both sides of a seam that meet when it is sewn.
#pragma once

#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// Places the notches of every seam at the same shares of the length on both sides, about
/// `spacing_mm` apart and away from the seam's ends, where all corners are. Their distances grow
/// along the seam: it cannot be sewn the other way round without notice. A notch near a sharp bend
/// moves to a straighter place close by, on both sides alike. 0 = no notches.
void set_notches(Pattern& pattern, double spacing_mm);

} // namespace devseg::pattern
