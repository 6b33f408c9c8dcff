// Nets: the faces of a polyhedron laid flat beside each other, hinged along as much of their
// common edges as they can be without lying on each other. Nothing is stretched or moved.
//
// References
//   [S97] W. Schlickenrieder: Nets of Polyhedra. TU Berlin, 1997 (spanning trees of hinges, and
//         how seldom the plain ones overlap)
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::papercraft {

struct NetOptions {
    int random_seed = 0; // varies the orders
    int most_faces = 0;  // of a net, those of one plane being one; 0: no limit
};

/// A face of a polyhedron is a flat region (see flat_regions.h): none is ever cut. Islands of faces
/// are hinged along their longest common edges first, as long as no two faces overlap in the plane;
/// several orders are tried on small surfaces, and the one with the fewest nets is kept, then the
/// one with the shortest cuts. Edges whose two sides come to lie on each other are no cuts. Every
/// chart is a disk, or a disk with holes that lie flat, and unfolds exactly as far as its faces are
/// flat. The mesh may have several components. Throws Cancelled.
atlas::ChartMap unfold_into_nets(const Mesh& mesh, const NetOptions& options,
                                 const Progress& progress);

} // namespace devseg::papercraft
