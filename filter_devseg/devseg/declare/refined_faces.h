// Faces that a filter has split, as faces of the host.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::declare {

/// The host's faces split as those behind the gate are. `parts`: of each of the host's faces, and
/// those that come to them, the part that it is; null where it is whole.
HostRefinement host_refinement(const HostMesh& host, const mesh::GatedMesh& gated,
                               const mesh::Refinement& fine,
                               const std::vector<const mesh::Refinement::Part*>& parts);

} // namespace devseg::declare
