// LPFB maps with an inside that is fit for sewing, and when they are accepted.
//
// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "devseg/flatten/maps/lpfb.h"

namespace devseg::flatten {

/// A map whose boundary has the lengths that it has on the surface.
struct LpfbMap {
    std::vector<Vec2> uv;     // #v, internal units
    double area_change = 0.0; // largest of a face, see AreaChange::largest
    double l2_stretch = 0.0;  // of the map as it is
};

struct SewingMapOptions {
    // A map in which no face changes its area by more, with at most so much L2 stretch, is good
    // enough: no other one is tried.
    double enough = 0.005;
    double enough_stretch = infinite;
    // Of a nearly isometric map: as-rigid-as-possible energy, and pairs of overlapping faces over
    // faces, above which the chart is given up. With a limit for overlaps it is also given up where
    // areas cannot be evened out without any.
    double give_up_energy = infinite;
    // Of the map with the least strain: the mean of ψ − 1 above which the chart is given up.
    double give_up_excess = infinite;
    std::optional<double> give_up_overlap;
    bool push_apart = true; // parts that overlap, while seams keep their lengths
};

/// A map by a few as-rigid-as-possible steps; empty where its energy is above a limit, or faces are
/// flipped.
std::vector<Vec2> nearly_isometric_map(const FlatteningProblem& problem, double give_up_energy,
                                       const Progress& progress);

/// The LPFB map for sewing: with the angles that the boundary has on the surface, and beside a
/// nearly isometric map whose areas were evened out while its boundary bends; the one in which
/// areas change less. The inside is the harmonic one where that is nearly an isometry; else it is
/// moved towards one, and then so that areas change evenly. Nothing where neither keeps [Wan08]'s
/// conditions: no flips, the area changes by at most 10 %, the L2 stretch is at most 2, and no
/// parts overlap by more than `tolerance`. Throws NumericalFailure for charts with holes.
std::optional<LpfbMap> sewing_map(const FlatteningProblem& problem,
                                  const atlas::ChartSurface& surface, double tolerance,
                                  const SewingMapOptions& options, const Progress& progress);

struct LeastStrainMap {
    std::vector<Vec2> uv; // #v, internal units
    bool pushed = false;  // parts overlapped and were pushed apart
};

/// The map for sewing with the least strain: from a nearly isometric map, the boundary bends while
/// its edges stay nearly as long as they are on the surface; then they get exactly that length, and
/// the inside follows. Nothing where faces flip, parts overlap by more than `tolerance` and do not
/// come apart, or a limit of the options is exceeded.
std::optional<LeastStrainMap> least_strain_map(const FlatteningProblem& problem,
                                               const atlas::ChartSurface& surface, double tolerance,
                                               const SewingMapOptions& options,
                                               const Progress& progress);

/// An LPFB map without flips, with its inside moved as above; nothing where it has flips.
std::optional<LpfbMap> settle_lpfb(const FlatteningProblem& problem, LpfbResult lpfb,
                                   const Progress& progress);

} // namespace devseg::flatten
