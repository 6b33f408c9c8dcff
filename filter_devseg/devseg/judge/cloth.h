// Trials of patches of cloth: what the map is like that 'Charts: Flatten' makes of them for sewing.
//
// References
//   [Wan08] C. C. L. Wang: Computing Length-Preserved Free Boundary for Quasi-Developable Mesh
//           Segmentation. IEEE Transactions on Visualization and Computer Graphics 14(1), 2008.
//           doi:10.1109/TVCG.2007.1067
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/strain.h"

namespace devseg::judge {

/// What is asked of a patch. In a search, where many patches are tried, patches far from an
/// isometry are given up early.
struct ClothLimits {
    // Of a face, as a share; asked for where max_strain is 0.
    double max_area_change = 0.15;
    // Of 99 % of the patch's area; twice as much anywhere, and a part of it in the mean.
    double max_strain = 0.2;
    bool is_search = true;

    bool by_strain() const { return max_strain > 0.0; }
};

struct ClothTrial {
    bool accepted = false;
    bool is_sound = false;       // a disk, or one with holes that unfolds exactly
    bool has_map = false;        // one that sews
    double area_change = 0.0;    // largest of a face
    flatten::Strain strain;      // measured at the lengths of the seams
    std::vector<Vec2> outline;   // of the map, counterclockwise, in internal units; of disks only
    std::vector<Index> face;     // of the mesh; with details only
    std::vector<double> change;  // of each face: area in the plane / on the surface − 1
    std::vector<double> strains; // of each face, where patches are judged by strain
};

/// The map for sewing of the faces, cut open along the marked edges (`seam`, 3 #F of the mesh, all
/// edges to other faces marked): that of 'Charts: Flatten' with LPFB, or with LPFB Even Areas where
/// no strain is asked for. Accepted if the patch is sound, the map keeps the limits, and nothing
/// overlaps; by areas also [Wan08]'s conditions. With `details` also what happens to each face, for
/// patches that are not accepted too; nothing where needles leave no map at all.
ClothTrial try_cloth(const Mesh& mesh, const std::vector<Index>& faces,
                     const std::vector<std::uint8_t>& seam, const ClothLimits& limits, bool details,
                     const Progress& progress);

/// How a conformal map of a disk, scaled to its area, changes the areas of its faces; no faces
/// where there is no map.
ClothTrial conformal_change(const Mesh& mesh, const std::vector<Index>& faces,
                            const std::vector<std::uint8_t>& seam);

/// A cut in two between the sheets of a disk whose map lies on itself, half-edges of the mesh;
/// empty where it does not. `has_map`: whether the patch has a map for sewing, which then does not.
std::vector<Index> cut_between_sheets(const Mesh& mesh, const std::vector<Index>& faces,
                                      const std::vector<std::uint8_t>& seam, bool has_map,
                                      const Progress& progress);

} // namespace devseg::judge
