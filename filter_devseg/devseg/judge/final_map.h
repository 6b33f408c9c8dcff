// The last word on charts: their maps as 'Charts: Flatten' makes them, on the surface itself.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/judge/trial.h"

namespace devseg::judge {

/// What charts are flattened for: least stretch by Symmetric Dirichlet, or cloth by LPFB, where
/// both sides of each seam keep their length.
enum class MapFor { texture, cloth };

/// The final maps of disjoint charts, each given by its faces (ascending), cut open along the
/// marked edges (`seam`, 3 #F of the mesh) and to disks: cut, flattened and repaired as the filter
/// does it. `flat` is false where a chart lies on itself and is cut apart by that; `part` is then
/// filled in, and the stretch is that of the parts. All cores; only the thread that runs the filter
/// may call it.
std::vector<TrialMap> final_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                                 const std::vector<std::uint8_t>& seam, Progress& progress,
                                 MapFor purpose = MapFor::texture);

struct WholeEffort {
    double most_l2 = 0.0;   // parts that overlap in maps that stretch by more stay so; 0: none
    bool push_apart = true; // parts that overlap
};

/// The same for charts that must stay in one piece, sooner: one that would be cut apart is not, and
/// its stretch is that of the map that lies on itself; infinite where there is none without flips.
std::vector<TrialMap> whole_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                                 const std::vector<std::uint8_t>& seam, const WholeEffort& effort,
                                 Progress& progress);

/// Whether the final map's L2 stretch is at most `l2` beyond doubt, from a bound that costs one
/// linear system. False says nothing.
bool is_surely_within(const Mesh& mesh, const std::vector<Index>& faces,
                      const std::vector<std::uint8_t>& seam, double l2, const Progress& progress);

} // namespace devseg::judge
