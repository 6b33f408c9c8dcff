// LPFB maps with an inside that is fit for sewing, and when they are accepted.
//
// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
#pragma once

#include <vector>

#include "devseg/flatten/lpfb.h"

namespace devseg {

/// A map whose boundary has the lengths that it has on the surface.
struct LpfbMap {
    double energy = 0.0;  // symmetric Dirichlet; infinite where the map has flips
    std::vector<Vec2> uv; // #v, internal units; empty where the map has flips
};

/// The harmonic inside as it is where it is nearly an isometry; else moved towards one, and then
/// so that areas change evenly.
LpfbMap settle_lpfb(const FlatteningProblem& problem, LpfbResult lpfb, const Progress& progress);

/// Largest share by which the area of a map may change [Wan08, section 5].
constexpr double lpfb_area_change = 0.1;

/// [Wan08, section 5]: the area changes by at most 10 %, and the L2 stretch is at most 2.
bool is_sewable(const FlatteningProblem& problem, const LpfbMap& map);

} // namespace devseg
