// Thin tips and tongues of patches.
#pragma once

#include "devseg/methods/plush/seam_removal.h"

namespace devseg::plush {

/// Gives what hangs on a patch and is narrower than `width` (internal units), the acute corners
/// where seams meet, teeth and strips, to the patch beside it, where both stay developable disks:
/// a seam across the tongue takes the place of a longer one along it. Returns how many changes were
/// tried.
Index give_tongues_away(const SeamSetting& setting, double width, SeamMarks& seam,
                        Progress& progress);

} // namespace devseg::plush
