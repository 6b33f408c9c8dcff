// The seams between pieces: how long each side is in the plane, and how far the sides differ.
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"

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

/// One record for each pair of charts that share a seam, sorted by the pair.
std::vector<SeamMeasures> measure_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                                        const CornerUv& uv);

} // namespace devseg::metrics
