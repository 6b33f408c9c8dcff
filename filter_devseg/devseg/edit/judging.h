// What charts that the user changes would cost: by the maps that 'Charts: Flatten' makes, for large
// charts by those of coarse versions of them.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/judge/final_map.h"
#include "devseg/mesh/coarsen.h"

namespace devseg::edit {

/// A map of a chart that was decimated for it.
struct CoarseMap {
    atlas::ChartSurface surface; // all of its faces
    Mesh chart;                  // the same as a mesh of its own
    mesh::CoarseMesh coarse;     // of `chart`
    std::vector<Vec2> uv;        // #v of `coarse.mesh`, not pushed; empty where that was cut further
};

struct QuickMaps {
    std::vector<judge::TrialMap> maps; // of all charts
    std::vector<CoarseMap> coarse;     // of those that were decimated, in the same order
};

/// Maps of disks that stay in one piece (see judge::whole_maps), each given by its faces. A user
/// waits for the answer: a chart of more than some thousand faces is decimated to so many, and its
/// map is that of the decimated chart, without `turns` and `worst_faces`. Its area is exact, its L2
/// stretch is good to a few 1e-4.
QuickMaps quick_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                     const std::vector<std::uint8_t>& seam, const judge::WholeEffort& effort,
                     Progress& progress);

/// Replaces maps of decimated charts by maps of all faces: what is good on fewer faces must be so
/// on all of them before it counts. A coarse map is refined; where that is not one-to-one within
/// the effort's bound, the map is that of judge::whole_maps. `turns` stay empty.
void confirm_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                  const std::vector<std::uint8_t>& seam, const judge::WholeEffort& effort,
                  QuickMaps& quick, Progress& progress);

} // namespace devseg::edit
