// How well a flattening keeps the shape of the surface, and whether it is valid.
//
// References
//   [SSGH01] P. V. Sander, J. Snyder, S. J. Gortler, H. Hoppe: Texture Mapping Progressive Meshes.
//            SIGGRAPH 2001. doi:10.1145/383259.383307
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/metrics/seams.h"

namespace devseg::metrics {

/// One chart. Extension and compression are those of a line in the material that goes from the
/// surface to the plane, at the worst place and in the worst direction.
struct ChartMeasures {
    double area = 0.0;        // on the surface, model units squared
    double l2_stretch = 0.0;  // as below, over this chart
    double extension = 0.0;   // max 1/γ − 1, no unit: 0.05 = lines get up to 5 % longer
    double compression = 0.0; // max 1 − 1/Γ, no unit: 0.05 = lines get up to 5 % shorter
    Index worst_face = -1;    // the face where the larger of the two occurs; −1 = none
};

/// Γ ≥ γ are the singular values of the map from the plane to the surface on a face, with the
/// chart scaled so that its area in the plane is its area on the surface. Sums run over faces that
/// have an area on both sides, weighted by the area A on the surface.
struct ParametrizationMeasures {
    Index charts_number = 0;
    Index disk_charts_number = 0;
    double l2_stretch = 0.0;   // √(Σ A (Γ² + γ²)/2 / Σ A) [SSGH01]; 1 for an isometry
    double linf_stretch = 0.0; // max Γ [SSGH01], over faces that are not flipped
    double l2_shear = 0.0;     // root mean square change of the triangles' angles, radians
    double symmetric_dirichlet_energy = 0.0; // Σ A (Γ² + γ² + Γ⁻² + γ⁻²)/4 / Σ A
    double max_area_change = 0.0;            // max |1 − area in the plane / area on the surface|
    Index flipped_faces_number = 0;     // oriented against most of their chart, or without area
    Index overlapping_faces_number = 0; // faces that lie on another face in the plane
    double seam_length = 0.0;           // of all cut edges, each counted once, model units
    double packing_efficiency = 0.0;    // covered share of the layout's bounding box
    std::vector<ChartMeasures> charts;
    std::vector<SeamMeasures> seams;
};

/// Charts are read from the texture coordinates, whoever made them.
ParametrizationMeasures measure_parametrization(const Mesh& mesh, const CornerUv& uv);

} // namespace devseg::metrics
