// The host's mesh cut open: how its vertices are duplicated.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::declare {

/// Gives each of the host's vertices to the first fan at it, and copies to the others. `fans` has a
/// number for each corner of the faces behind the gate (#F): corners of one vertex with the same
/// number stay together. A face that the gate has left out goes where the face that stands in for
/// it goes, at the corners that they share: a doubled face stays on its twin.
HostRefinement host_opening(const HostMesh& host, const mesh::GatedMesh& gated,
                            const std::vector<Triangle>& fans);

} // namespace devseg::declare
