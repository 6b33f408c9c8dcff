// Where seams look natural: along the body, on creases and where limbs begin.
#pragma once

#include <optional>

#include "devseg/plush/seam_network.h"
#include "devseg/plush/skeleton.h"
#include "devseg/plush/symmetry.h"

namespace devseg {

/// How much the surface bends across each edge, 3 #F, radians, positive where it is convex: the
/// angle between the mean normals on both sides, within 1.5 % of the mesh's diagonal. 0 on the
/// boundary.
std::vector<double> bends_across_edges(const Mesh& mesh, const Progress& progress);

/// How far an edge is from where seams look natural, 0 … 1: 0 within 20 degrees of the skeleton's
/// direction, on creases and in concave places, where limbs begin; 1 across smooth limbs. `across`:
/// 1 − |cos| of the angle to the skeleton, times how much its bones agree.
double straying(double across, double bend);

/// What a maker looks at in a layout of seams.
struct SeamMeasures {
    // Share of the seam length that runs within 30 degrees of the skeleton (over 4 % of the
    // diagonal, because seams follow edges), on creases of 30 degrees or in concave places.
    double guided_share = 0.0;
    // Share that has its mirror image within 2 % of the diagonal; 0 without a plane.
    double mirrored_share = 0.0;
};

/// `skeleton` may be empty: then only creases and concave places count.
SeamMeasures measure_seams(const Mesh& mesh, const SeamMarks& seam, const Skeleton& skeleton,
                           const std::optional<MirrorPlane>& plane, const Progress& progress);

} // namespace devseg
