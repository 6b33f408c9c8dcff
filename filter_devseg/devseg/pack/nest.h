// Nesting: charts into a square as small as a fixed effort finds, in two stages.
//
// 1. On a coarse grid, charts in many orientations are inserted one by one; then the square is
//    shrunk in small steps and the overlaps that appear are separated again.
// 2. On a fine grid, whose images are conservative, the layout found is separated and shrunk
//    further by small moves and turns. What it returns keeps the distance exactly.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pack/pack.h"
#include "devseg/pack/separation.h"

namespace devseg {

struct NestProblem {
    std::vector<Outline> outlines;
    double padding = 0.0;          // share of the square's side
    bool allow_rotation = true;    // by any angle
    double side = 1.0;             // a guess of the square's
    double cell = 1.0;             // of the coarse grid
    std::vector<ChartPoses> poses; // on the coarse grid
};

/// Fills in the coarse grid.
void prepare(NestProblem& problem, Progress& progress);

/// The layout for one seed, in a rectangle whose height is `aspect` times its width.
std::vector<Placement> nest(const NestProblem& problem, double aspect, std::uint64_t seed,
                            const Progress& progress);

} // namespace devseg
