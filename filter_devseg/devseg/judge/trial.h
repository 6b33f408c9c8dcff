// Trial flattenings: what a set of faces would cost if it were one chart.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/flatten/energy/strain.h"

namespace devseg::judge {

/// Stretch of one chart's map [Sander et al. 2001], as in measure_parametrization.
struct TrialMap {
    bool flat = false;       // a map without flips was found
    bool overlaps = false;   // parts of it overlap in the plane
    double area = 0.0;       // on the surface, internal units squared
    double l2_squared = 1.0; // mean of (Γ² + γ²) / 2 over the area, at the chart's own area
    double linf = 1.0;       // max Γ
    flatten::Strain strain;  // of the map as it is
    double cut_length = 0.0; // of the cuts that made it a disk, internal units
    std::vector<Index> worst_faces; // of the mesh: local maxima of the stretch, the worst first
    std::vector<double> peaks;      // Γ there
    std::vector<Index> part; // of each face, where flattening cuts the chart apart; else empty
    std::vector<Vec2> turns; // of each face, see flatten::face_turns, in the order of the faces

    /// Σ A (l2² − 1): what the charts of a segmentation add up to.
    double excess() const { return area * (l2_squared - 1.0); }
    /// Σ (Γ − bound) over the peaks above the bound.
    double peaks_above(double bound) const;
};

struct TrialEffort {
    double wanted_l2 =
        1.005;               // what the stretch is compared with: decides how exact the map must be
    bool give_up = false;    // stop early if it will be above; what is measured then is too much
    bool push_apart = false; // try to push overlapping parts apart
    bool only_near = false;  // not flat where `turns` do not nearly fit together
    // Not flat, and not looked at further, where the cuts that make it a disk are longer.
    double most_cut_length = infinite; // internal units
    bool only_apart = false; // not flat where parts overlap deeply in a map near to the best one
};

/// Flattens the faces as one chart, cut open along the marked edges (`seam`, 3 #F of the mesh;
/// edges to other faces need no mark) and to a disk where it is none. A few rounds: enough to
/// compare. Starts from `turns` (of each face) if they are given: those of a map with other cuts,
/// or of the maps of two charts that are joined.
TrialMap try_chart(const Mesh& mesh, const std::vector<Index>& faces,
                   const std::vector<std::uint8_t>& seam, const TrialEffort& effort,
                   const Progress& progress, const std::vector<Vec2>& turns = {});

/// Fills in the area, the stretch and the strain of a map; returns Γ of each face.
std::vector<double> measure_stretch(const flatten::FlatteningProblem& problem,
                                    const std::vector<Vec2>& uv, TrialMap& map);

} // namespace devseg::judge
