// Where seams look natural: along the body, on creases and where limbs begin. Edges have low
// weights there.
#pragma once

#include <optional>

#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/surface_fields.h"
#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

/// The surface at an edge.
struct EdgeShape {
    double bend = 0.0;           // radians, positive where convex; 0 on the boundary
    Vec3 normal = Vec3::UnitZ(); // unit
};

/// Of each half-edge, 3 #F: by the mean normals on both sides, within 1.5 % of the mesh's diagonal.
std::vector<EdgeShape> edge_shapes(const Mesh& mesh, const Progress& progress);

/// How far an edge is from where seams look natural, 0 … 1: 0 within 20 degrees of the skeleton's
/// direction, on creases and in concave places; 1 across smooth limbs. `across`: 1 − |cos| of the
/// angle to the skeleton, times how much its bones agree.
double straying(double across, double bend);

/// Exponents of the three terms of an edge's weight, no unit.
struct SeamWeightOptions {
    double geodesic = 0.3;  // α
    double skeleton = 0.3;  // β
    double curvature = 0.8; // γ
};

/// w = w_g^α w_s^β w_c^γ for each half-edge (3 #F): w_g the length over the longest edge, w_s low
/// along the skeleton, w_c low where the mean curvature (#V) is high. 0 < w ≤ 10. Without a
/// skeleton w_s is 1. Beyond [Plush], w is several times lower where seams look natural, which
/// `straying` tells, and ten times higher within large flat regions.
struct SeamWeights {
    std::vector<double> weight; // 3 #F
    std::vector<double> stray;  // 3 #F, 0 … 1
};
SeamWeights seam_weights(const Mesh& mesh, const SeamWeightOptions& options,
                         const std::vector<double>& curvature, const Skeleton& skeleton,
                         const BoneWeights& bones, const Progress& progress);

/// Of a cost, of which a share goes where seams look natural.
inline double natural_factor(double share, double stray) {
    return 1.0 - share + share * stray;
}

/// Lengths of half-edges (3 #F), times that factor for each.
std::vector<double> natural_lengths(const Mesh& mesh, const std::vector<double>& stray,
                                    double share);

/// What seams follow: bones, or none, and the borders of limbs.
struct SeamGuides {
    struct Line {
        Vec3 from;
        Vec3 to;
    };
    Skeleton skeleton;
    std::vector<Line> limb_borders;
};

/// What a maker looks at in a layout of seams.
struct SeamShares {
    // Of the seam length: within 30 degrees of the skeleton's direction on the surface, or of a
    // limb's border that is within 1.5 % of the diagonal (directions over 4 % of the diagonal,
    // because seams follow edges), on creases of 30 degrees or in concave places.
    double guided = 0.0;
    // Of the seam length: with a mirror image within 2 % of the diagonal; 0 without a plane.
    double mirrored = 0.0;
};
SeamShares seam_shares(const Mesh& mesh, const SeamMarks& seam, const SeamGuides& guides,
                       const std::optional<MirrorPlane>& plane, const Progress& progress);

} // namespace devseg::plush
