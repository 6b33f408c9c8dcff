// Evening out the areas of a map with a fixed boundary: the inside of LPFB maps for sewing.
// A high power of each face's area change is minimised beside the symmetric Dirichlet energy, by
// projected Newton steps.
//
// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Changes of area up to this are usual for LPFB [Wan08, section 5], of a face and of a whole map.
constexpr double usual_area_change = 0.1;

/// How much the areas of faces change: in the plane over on the surface.
struct AreaChange {
    double least = 1.0; // smallest ratio of a face
    double most = 1.0;  // largest ratio of a face
    double whole = 1.0; // of the whole map

    /// The largest relative change of a face, as it is and with the map scaled to its area on the
    /// surface, whichever of the two areas it is compared with then.
    double largest() const;
};

AreaChange measure_area_change(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// Moves inner vertices until no face changes its area by more than a tenth, or it does not get
/// better. The boundary stays, and no face is flipped. Does nothing where all faces keep their
/// areas within a tenth already.
void balance_areas(const FlatteningProblem& problem, std::vector<Vec2>& uv,
                   const Progress& progress);

/// The same for all vertices: the boundary may bend, and its edges keep their lengths but for a
/// small rest. `uv` has no flips.
std::vector<Vec2> balance_with_boundary(const FlatteningProblem& problem,
                                        const std::vector<Vec2>& uv, const Progress& progress);

} // namespace devseg::flatten
