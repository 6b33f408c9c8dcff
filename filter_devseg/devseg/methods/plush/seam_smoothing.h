// Seams without teeth and detours.
#pragma once

#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/seam_removal.h"

namespace devseg::plush {

/// Gives faces that stick out of their label, with two edges to one other label, to that one, again
/// and again.
void remove_teeth(const Mesh& mesh, std::vector<Index>& label);

/// Replaces each segment by the shortest path between its ends within a few rings of faces around
/// it, a closed one in two parts, together with its mirror image, where the patches beside it stay
/// developable disks.
void straighten_seams(const SeamSetting& setting, SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
