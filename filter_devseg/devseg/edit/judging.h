// What charts that the user changes would cost: by the maps that 'Charts: Flatten' makes, for large
// charts by those of coarse versions of them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/flatten/coarse_map.h"
#include "devseg/judge/final_map.h"

namespace devseg::edit {

struct CoarseChart {
    atlas::ChartSurface surface; // all of its faces
    flatten::CoarseMap map;
};

struct QuickMaps {
    std::vector<judge::TrialMap> maps;              // of all charts
    std::vector<std::optional<CoarseChart>> coarse; // of those that were decimated
};

/// Maps of disks that stay in one piece (see judge::whole_maps), each given by its faces. A user
/// waits for the answer: a chart of more than some thousand faces is decimated to so many, and its
/// map is that of the decimated chart, without `turns` and `worst_faces`. Its area is exact, its L2
/// stretch is good to a few 1e-4, a few 1e-3 where parts were pushed apart.
QuickMaps quick_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                     const std::vector<std::uint8_t>& seam, const judge::WholeEffort& effort,
                     Progress& progress);

/// Replaces maps of decimated charts by maps of all faces: what is good on fewer faces must be so
/// on all of them before it counts. A coarse map is refined to all faces. Flattening finds this map
/// as well, where it finds none that is better; so it proves that the chart stays in one piece.
/// Where it is not one-to-one within the effort's bound, the map is that of judge::whole_maps.
void confirm_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                  const std::vector<std::uint8_t>& seam, const judge::WholeEffort& effort,
                  QuickMaps& quick, Progress& progress);

} // namespace devseg::edit
