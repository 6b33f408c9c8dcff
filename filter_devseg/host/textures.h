// Texture images, which hosts keep in memory or, before 2021, in files beside the mesh.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"
#include "host/meshlab_api.h"

namespace devseg::host {

/// The images of the mesh, and the coordinates that fit them (see keep_old_uv), if it has both.
void read_textures(MeshModel& model, declare::HostMesh& host);

/// Before coordinates are replaced: keeps those of a mesh with textures, as face attributes.
void keep_old_uv(MeshModel& model);

/// Before charts get their colours: keeps those of a model's own faces, as a face attribute.
void keep_old_colors(MeshModel& model);

/// What the surface looks like: as read_textures, with the mesh's own coordinates where it keeps no
/// others, and the colours of its faces or else of its vertices. Colours of charts are none.
void read_surface(MeshModel& model, declare::HostMesh& host);

/// Gives the mesh one image instead of its textures; forgets the old coordinates. Throws HostError
/// where a host that keeps images in files cannot write one.
void replace_textures(MeshModel& model, const plane::Image& image);

} // namespace devseg::host
