// Curved vertices that curves keep passing through.
#pragma once

#include <vector>

#include "devseg/curves/bending.h"
#include "devseg/curves/curved_vertices.h"

namespace devseg::curves {

class Anchors {
public:
    /// None yet.
    Anchors(const Network& network, const CurvedVertices& curved);

    /// Adds curved vertices that a curve passes nearby.
    void add_near(const Network& network);

    /// Where the vertices hold the curves along the stops.
    std::vector<Hold> holds(const Network& network, const std::vector<Stop>& stops,
                            const std::vector<FlatStop>& flat) const;

private:
    void add_holds(const Network& network, const std::vector<Stop>& stops,
                   const std::vector<FlatStop>& flat, bool left, std::vector<Hold>& holds) const;

    const CurvedVertices& curved_;
    std::vector<Index> curve_; // #V: the one that passes, −1 = none
};

} // namespace devseg::curves
