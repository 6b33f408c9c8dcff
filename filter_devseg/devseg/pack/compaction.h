// Compaction: the exact outlines of a finished layout are pushed closer together, all at once.
//
// Round by round, each pair of an outline's vertex and another chart's edge that are close to one
// another bounds the charts' moves. The least moves that keep these bounds while the walls come
// closer are a quadratic program. The bounds hold for small moves only, hence the rounds; what a
// round misses, the next one makes up for.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pack/outline.h"
#include "devseg/pack/pack.h"

namespace devseg::pack {

/// How bad a layout with a box of this size is. Efficiency counts the box; of two boxes that are
/// about as large, the one closer to a square is better.
double badness(const Vec2& box);

/// A layout that is as good or better than `placements`, whose charts are at least
/// options.padding times the square's side apart: moved and, if allowed, turned a little.
std::vector<Placement> compact(const std::vector<Outline>& outlines,
                               const std::vector<Placement>& placements, const PackOptions& options,
                               const Progress& progress);

/// A strip of fixed width along y, from x = 0 on.
struct StripWalls {
    double width = 0.0;
    double gap = 0.0;                   // least distance of two charts
    std::vector<std::uint8_t> may_turn; // #charts
    std::vector<std::uint8_t> at_left;  // #charts: they keep their x
};

/// The same on a strip, which gets shorter.
std::vector<Placement> compact_strip(const std::vector<Outline>& outlines,
                                     const std::vector<Placement>& placements,
                                     const StripWalls& walls, const Progress& progress);

} // namespace devseg::pack
