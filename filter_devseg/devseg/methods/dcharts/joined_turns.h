// Where the trial of a closing begins: with the maps that there are.
#pragma once

#include <vector>

#include "devseg/methods/dcharts/seam_chains.h"

namespace devseg::dcharts {

/// How the faces of both charts are turned in the plane (see flatten::face_turns), those of the
/// second so that the closed edges lie along each other; empty where a chart has no map, and where
/// the closing opens edges: what lies between both cuts has turned.
std::vector<Vec2> joined_turns(const Mesh& mesh, const Draft& draft, const Closing& closing);

} // namespace devseg::dcharts
