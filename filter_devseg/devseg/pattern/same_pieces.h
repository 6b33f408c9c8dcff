// Pieces that have one shape and are cut together.
#pragma once

#include <optional>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/outline_shapes.h"
#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

/// The first piece that a piece has the shape of: itself, or one before it.
struct Likeness {
    std::size_t model = 0;
    bool mirrored = false;
    Motion motion; // brings its Shape, mirrored if so, onto that of the model
};

/// Of each piece: rigid motions are fitted to points spaced evenly along the outlines, and hold
/// where no outline is farther than `tolerance_mm`, and that share of the piece's size, from the
/// other. Each piece is compared with the few shapes before it whose Fourier descriptors are most
/// similar. The pieces are measured.
std::vector<Likeness> find_likenesses(const std::vector<PatternPiece>& pieces, double tolerance_mm,
                                      double share, const Progress& progress);

/// Sets model, mirrored and the quantities of pieces of the same shape, within the tolerance and a
/// hundredth of their size.
void find_same_pieces(std::vector<PatternPiece>& pieces, double tolerance_mm,
                      const Progress& progress);

struct MirrorAxis {
    Vec2 point = Vec2::Zero();      // mm
    Vec2 direction = Vec2::UnitY(); // unit
};

/// Where the piece is its own mirror image, within the same tolerance.
std::optional<MirrorAxis> find_mirror_axis(const PatternPiece& piece, double tolerance_mm);

/// The motion that brings the mirrored piece onto itself, within the tolerance and that share of
/// its size, if there is one.
std::optional<Motion> mirror_motion(const PatternPiece& piece, double tolerance_mm, double share);

} // namespace devseg::pattern
