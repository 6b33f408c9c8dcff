// Vertices that curves keep passing through: a seam there takes up the curvature of the surface,
// which is all in the vertices of a mesh. Beside a seam it would stretch the chart.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/curves/bending.h"

namespace devseg::curves {

class Anchors {
public:
    /// Vertices inside of the seams' paths that are so curved that seams stay there. `firm` (3 #F):
    /// 1 on edges near which they stay at less curved ones as well.
    Anchors(const Network& network, const std::vector<std::uint8_t>& firm);

    /// Adds curved vertices that a curve passes nearby.
    void add_near(const Network& network);

    /// Where the vertices hold the curves along the stops.
    std::vector<Hold> holds(const Network& network, const std::vector<Stop>& stops,
                            const std::vector<FlatStop>& flat) const;

private:
    void add_holds(const Network& network, const std::vector<Stop>& stops,
                   const std::vector<FlatStop>& flat, bool left, std::vector<Hold>& holds) const;

    std::vector<double> defect_;     // #V: its magnitude, radians
    std::vector<std::uint8_t> firm_; // #V: 1 near firm seams
    std::vector<Index> curve_;       // #V: the one that passes, −1 = none
};

} // namespace devseg::curves
