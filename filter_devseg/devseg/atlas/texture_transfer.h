// Textures baked into another layout of the same surface.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"
#include "devseg/plane/image.h"
#include "devseg/plane/plane.h"

namespace devseg::atlas {

/// Coordinates with the images that they refer to.
struct TexturedLayout {
    const CornerUv& uv;             // 3 #F
    const std::vector<Index>& page; // #F: position in `images`, others have no colour
    const std::vector<plane::Image>& images;
};

/// What a face shows; none where it has no image or no finite coordinates.
const plane::Image* image_of(const TexturedLayout& layout, Face f);

/// An image of size × size pixels for the layout `uv` (3 #F) in the unit square, in which the
/// surface looks as with `old`. Every pixel within `padding` pixels of a chart takes the colour of
/// the nearest place on it. Sets the share of pixels that were filled.
plane::Image transfer_texture(const Mesh& mesh, const CornerUv& uv, const TexturedLayout& old,
                              int size, int padding, double& filled, const Progress& progress);

} // namespace devseg::atlas
