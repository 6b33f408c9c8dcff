// Where the faces of a piece lie when its outline was changed.
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// The places on paper of all corners of the given faces, in mm: 3 for each. Corners follow the
/// outlines of the piece, which may have been changed to match its seams: a corner on an outline
/// moves with it, one inside by a mean of all moves.
std::vector<Vec2> place_corners(const Mesh& mesh, const CornerUv& uv,
                                const std::vector<Index>& faces, const PatternPiece& piece);

} // namespace devseg::pattern
