// Holes that lie flat with the surface around them: their contours stay inside the chart, and no
// slit to its rim is needed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devseg/atlas/charts.h"

namespace devseg::atlas {

/// A loop is the contour of a flat hole if it closes when it is laid into the plane by its lengths
/// and by the angles of the chart's faces: once around, with the chart outside.
struct HoleRule {
    // Radians that the turns may lack to a full one. A cone of that much flattens with an L2
    // stretch of about 1.00001, whatever is done around it.
    double turn = 0.02;
    double gap = 0.01; // share of the contour's length that may be missing between its ends

    /// What an exact development bears, to within the 32 bits of hosts.
    static HoleRule exact() { return {1e-5, 1e-6}; }
    /// Every loop but one gets a slit.
    static HoleRule none() { return {-1.0, -1.0}; }
};

/// 1 for each boundary loop (#loops) that is the contour of a flat hole, 0 for the others. Where
/// all loops are flat there is no rim, as on a box with two holes: none counts as a hole then.
std::vector<std::uint8_t> flat_holes(const Mesh& mesh, const ChartSurface& surface,
                                     const HoleRule& rule = {});

/// Whether a chart can be flattened and cut out as it is: a disk, or a disk with holes that lie
/// flat with it.
bool is_sound(const Mesh& mesh, const ChartSurface& surface, const HoleRule& rule = {});

/// The flat holes of a chart that is sound, nothing where it is not.
std::optional<std::vector<std::uint8_t>> sound_holes(const Mesh& mesh, const ChartSurface& surface,
                                                     const HoleRule& rule = {});

} // namespace devseg::atlas
