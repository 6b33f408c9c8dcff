// The host's faces split, with all that it keeps for faces and vertices.
#pragma once

#include "devseg/declare/filter.h"
#include "host/meshlab_api.h"

namespace devseg::host {

/// Gives the mesh its new vertices and faces. Parts of a face have its colour, quality, flags and
/// custom attributes; new vertices the mean of what is at the corners, and of attributes that are
/// no numbers what the nearest corner has. Wedge texture coordinates are interpolated.
void split_faces(MeshModel& model, const declare::HostRefinement& refinement);

} // namespace devseg::host
