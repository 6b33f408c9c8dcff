// Pieces that have one shape and are cut together.
#pragma once

#include <optional>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

/// Finds pieces of the same shape, straight or mirrored: rigid motions are fitted to points spaced
/// evenly along the outlines, and hold where no outline is farther than `tolerance_mm` (and a
/// hundredth of the piece's size) from the other. Each piece is compared with the few shapes before
/// it whose Fourier descriptors are most similar. Sets model, mirrored and the quantities.
void find_same_pieces(std::vector<PatternPiece>& pieces, double tolerance_mm,
                      const Progress& progress);

struct MirrorAxis {
    Vec2 point = Vec2::Zero();      // mm
    Vec2 direction = Vec2::UnitY(); // unit
};

/// Where the piece is its own mirror image, within the same tolerance.
std::optional<MirrorAxis> find_mirror_axis(const PatternPiece& piece, double tolerance_mm);

} // namespace devseg::pattern
