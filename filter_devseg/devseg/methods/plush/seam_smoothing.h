// Seams without detours.
#pragma once

#include "devseg/methods/plush/patch_tester.h"

namespace devseg::plush {

/// Replaces each segment by the shortest path between its ends within a few rings of faces around
/// it, a closed one in two parts, together with its mirror image, where the patches beside it stay
/// developable disks.
void straighten_seams(const SeamSetting& setting, SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
