// Curves on the surface, smoothed by length and bending.
#pragma once

#include "devseg/base/progress.h"
#include "devseg/curves/network.h"

namespace devseg::curves {

/// Moves the crossings and junctions of the network until waves shorter than `scale` (internal
/// units) have gone. Curves keep to their sides of each other, of held curves and of nodes; at
/// junctions, the two curves that go on into each other are smoothed as one.
void smooth(Network& network, double scale, Progress& progress);

} // namespace devseg::curves
