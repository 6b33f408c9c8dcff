// The faces that a curve passes through, unfolded into the plane.
#pragma once

#include <array>
#include <vector>

#include "devseg/curves/network.h"

namespace devseg::curves {

/// A crossing or a node on the way along one or more curves.
struct Stop {
    Index crossing = -1;
    Index node = -1;
    bool forwards = true; // along the crossing's curve
    HalfEdge leaving;     // of a crossing: from the face before it
};

/// Where a stop lies in the plane. The strip is isometric to its faces.
struct FlatStop {
    Vec2 point;
    double along = 0.0; // length of the curve up to there
    Vec2 right;         // of a crossing: the ends of its edge
    Vec2 left;
    std::array<Vec2, 3> corners; // of a junction: those of its face
};

/// The strip of the stops, each in the face that the one before it leads to.
std::vector<FlatStop> unfold(const Network& network, const std::vector<Stop>& stops);

} // namespace devseg::curves
