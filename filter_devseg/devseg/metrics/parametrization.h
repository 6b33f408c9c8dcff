// How well a flattening keeps the shape of the surface, whether it is valid, and how far the sides
// of its seams differ.
//
// References
//   [SSGH01] P. V. Sander, J. Snyder, S. J. Gortler, H. Hoppe: Texture Mapping Progressive Meshes.
//            SIGGRAPH 2001. doi:10.1145/383259.383307
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/flatten/energy/strain.h"

namespace devseg::metrics {

/// All edges along which two charts meet; a dart, slit or disk cut joins a chart to itself. Lengths
/// are flat, at the one scale at which the layout has the surface's area, in model units.
struct SeamMeasures {
    Index chart_a = 0; // chart_a ≤ chart_b
    Index chart_b = 0;
    double surface_length = 0.0; // on the surface, model units
    double length_a = 0.0;       // of the side in chart_a
    double length_b = 0.0;       // of the side in chart_b

    double mismatch() const { return length_a - length_b; } // model units
    /// Of the mean length, percent.
    double mismatch_percent() const {
        const double mean = 0.5 * (length_a + length_b);
        return mean > 0.0 ? 100.0 * mismatch() / mean : 0.0;
    }
};

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
    Index holed_charts_number = 0; // disks but for holes that lie flat with them
    double l2_stretch = 0.0;       // √(Σ A (Γ² + γ²)/2 / Σ A) [SSGH01]; 1 for an isometry
    double linf_stretch = 0.0;     // max Γ [SSGH01], over faces that are not flipped
    double l2_shear = 0.0;         // root mean square change of the triangles' angles, radians
    double symmetric_dirichlet_energy = 0.0; // Σ A (Γ² + γ² + Γ⁻² + γ⁻²)/4 / Σ A
    double max_area_change = 0.0;            // max |1 − area in the plane / area on the surface|
    // max(Γ − 1, 1 − γ), at the one scale at which the layout has the surface's area: what 99 % of
    // the area keeps, the largest of a face, and the mean. Flipped faces have none.
    flatten::Strain strain;
    Index flipped_faces_number = 0;     // oriented against most of their chart, or without area
    Index overlapping_faces_number = 0; // faces that lie on another face in the plane
    double seam_length = 0.0;           // of all cut edges, each counted once, model units
    double packing_efficiency = 0.0;    // covered share of the layout's bounding box
    std::vector<ChartMeasures> charts;
    std::vector<SeamMeasures> seams;
};

/// Charts are read from the texture coordinates, whoever made them.
ParametrizationMeasures measure_parametrization(const Mesh& mesh, const CornerUv& uv);

/// One record for each pair of charts that share a seam, sorted by the pair.
std::vector<SeamMeasures> measure_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                                        const CornerUv& uv);

} // namespace devseg::metrics
