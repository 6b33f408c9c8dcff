// What charts that the user changes would cost: by the maps that 'Charts: Flatten' makes, for large
// charts by those of coarse versions of them.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/judge/final_map.h"

namespace devseg::edit {

/// Maps of disks that stay in one piece (see judge::whole_maps), each given by its faces. A user
/// waits for the answer: a chart of more than some thousand faces is decimated to so many, and its
/// map is that of the decimated chart, without `turns` and `worst_faces`. Its area is exact, its L2
/// stretch is good to a few 1e-4.
std::vector<judge::TrialMap> quick_maps(const Mesh& mesh,
                                        const std::vector<std::vector<Index>>& charts,
                                        const std::vector<std::uint8_t>& seam,
                                        const judge::WholeEffort& effort, Progress& progress);

/// The same maps, those of decimated charts replaced by the maps of all faces: what is good on
/// fewer faces must be so on all of them before it counts.
void confirm_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                  const std::vector<std::uint8_t>& seam, const judge::WholeEffort& effort,
                  std::vector<judge::TrialMap>& maps, Progress& progress);

} // namespace devseg::edit
