// Further seams where patches are not developable enough yet.
#pragma once

#include "devseg/methods/plush/patch_tester.h"

namespace devseg::plush {

/// Makes every patch a disk, and splits those that do not keep the limits, along the isoline half
/// way to their worst spot, or where that is too small a part of the patch, by a path through the
/// worst spot, until all are developable; returns whether they are. Marks stay symmetric where the
/// surface is. `open`: 0 for faces of patches that stay as they are (#F), or empty.
bool add_local_seams(const SeamSetting& setting, std::vector<std::uint8_t> open, SeamMarks& seam,
                     Progress& progress);

} // namespace devseg::plush
