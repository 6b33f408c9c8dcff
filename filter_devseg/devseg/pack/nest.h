// Nesting: charts into a frame as small as a fixed effort finds, in three stages.
//
// 1. On a coarse grid, charts in many orientations are inserted one by one; then the square is
//    shrunk in small steps and the overlaps that appear are separated again.
// 2. On a fine grid, whose images are conservative, the layout found is separated and shrunk
//    further by small moves and turns. What it returns keeps the distance exactly.
// 3. The exact outlines are compacted (see compaction.h).
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pack/pack.h"
#include "devseg/pack/separation.h"

namespace devseg::pack {

constexpr std::size_t few_charts = 5;         // that cannot fill a square
constexpr std::size_t many_charts = 40;       // from here on a first fit is tried, moves are short
constexpr std::size_t very_many_charts = 250; // from here on nesting takes seconds
constexpr int few_orientations = 8;           // of very many charts, and in a first fit

struct NestProblem {
    std::vector<Outline> outlines;
    double padding = 0.0;          // share of the square's side
    bool allow_rotation = true;    // by any angle
    bool is_thorough = false;      // goes on where twice the work gains 0.5 %
    double side = 1.0;             // a guess of the square's
    double cell = 1.0;             // of the coarse grid
    std::vector<ChartPoses> poses; // on the coarse grid
};

/// Fills in the coarse grid.
void prepare(NestProblem& problem, Progress& progress);

/// What a search has found on the coarse grid.
struct CoarseLayout {
    Layout layout;
    Frame frame;
    double aspect = 1.0;
    std::uint64_t seed = 0;
};

/// A first part of the coarse search, in a frame whose height is about `aspect` times its width.
CoarseLayout begin_nesting(const NestProblem& problem, double aspect, std::uint64_t seed,
                           const Progress& progress);

/// The rest of the coarse search and what follows it.
std::vector<Placement> finish_nesting(const NestProblem& problem, const CoarseLayout& begun,
                                      const Progress& progress);

} // namespace devseg::pack
