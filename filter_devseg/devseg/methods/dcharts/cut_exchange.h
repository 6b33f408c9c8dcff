// Cuts inside charts in other places: a chain of seam edges is closed, and the shortest path opens
// between what it held together, so that the chart stays a disk.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/methods/dcharts/seam_chains.h"

namespace devseg::dcharts {

/// Half-edges of the shortest path inside the chart between the two parts into which its seams fall
/// without the chain, which has the chart on both sides. None where they do not fall apart, or
/// where no path is shorter. Cuts through flat regions count as in atlas/border_path.h.
std::vector<Index> shorter_cut(const Mesh& mesh, const Draft& draft, const Closing& chain,
                               const Progress& progress);

/// All cuts inside the chart along other ways: a tree of shortest paths [TM80] that joins the other
/// seams around the chart and leads to where cuts end now; and the same without one of these ends.
/// Those that are shorter, each with what closes and what opens.
///
///   [TM80] H. Takahashi, A. Matsuyama: An Approximate Solution for the Steiner Problem in Graphs.
///          Mathematica Japonica 24, 1980.
std::vector<Closing> rerouted_cuts(const Mesh& mesh, const Draft& draft, Index chart,
                                   const Progress& progress);

} // namespace devseg::dcharts
