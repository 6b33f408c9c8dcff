// Whether a set of faces is developable enough for one piece of cloth.
//
// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

struct PatchTrial {
    bool accepted = false;
    bool is_sound = false;      // a disk, or one with holes that unfolds exactly
    double area_change = 0.0;   // largest of a face; only where the patch has a map
    std::vector<Index> face;    // of the mesh; with details only
    std::vector<double> change; // of each face: area in the plane / on the surface − 1
};

/// What is asked of a patch. In a search, where many patches are tried, the shear is held lower,
/// and patches far from an isometry are given up early: another surface than the one it is made on
/// may be a little worse.
struct PatchLimits {
    double max_area_change = 0.15;
    bool is_search = true;
};

/// The map that 'Charts: Flatten' with LPFB makes of the faces, cut open along the marked edges
/// (`seam`, 3 #F of the mesh, all edges to other faces marked): accepted if it is sound, keeps
/// [Wan08]'s conditions, no face changes its area by more than the limit, and nothing overlaps.
/// With `details` also the change of each face, for patches that are not accepted too; none where
/// needles leave no map at all.
PatchTrial try_patch(const Mesh& mesh, const std::vector<Index>& faces,
                     const std::vector<std::uint8_t>& seam, const PatchLimits& limits, bool details,
                     const Progress& progress);

/// How a conformal map of a disk, scaled to its area, changes the areas of its faces; no faces
/// where there is no map.
PatchTrial conformal_change(const Mesh& mesh, const std::vector<Index>& faces,
                            const std::vector<std::uint8_t>& seam);

/// Trials on one surface. None is made twice: a patch and its mirror image are one. Threads may
/// share it.
class PatchTester {
public:
    PatchTester(const WorkingSurface& surface, const PatchLimits& limits)
        : surface_(surface), limits_(limits) {}

    /// Whether the patch is developable. `seam` as for try_patch, symmetric where the surface is.
    bool accepts(const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                 const Progress& progress);
    bool accepts_all(const std::vector<std::vector<Index>>& patches,
                     const std::vector<std::uint8_t>& seam, const Progress& progress);
    const PatchLimits& limits() const { return limits_; }

private:
    const WorkingSurface& surface_;
    const PatchLimits limits_;
    std::mutex mutex_;
    std::map<std::vector<Index>, bool> known_; // 8 f + marks of its edges
};

} // namespace devseg::plush
