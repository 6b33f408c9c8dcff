// Folds that follow their piece's outline.
#pragma once

#include "devseg/mesh/texture.h"
#include "devseg/pattern/pattern.h"

namespace devseg {

/// Outlines move a little where they are simplified and where the two sides of a seam are made
/// equally long; folds lie where the texture coordinates put them. Here they are moved as their
/// surroundings on the outline are, by mean value coordinates, and those that still lie outside of
/// the piece, along its border, are left out.
void carry_folds(const CornerUv& uv, Pattern& pattern);

} // namespace devseg
