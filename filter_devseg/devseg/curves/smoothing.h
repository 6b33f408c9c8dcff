// Curves on the surface, smoothed by length and bending.
#pragma once

#include "devseg/base/progress.h"
#include "devseg/curves/network.h"

namespace devseg::curves {

/// Moves the crossings and junctions of the network until waves shorter than `scale` (internal
/// units) have gone. Curves keep to their sides of each other, of held curves and of nodes; at
/// junctions, the two curves that go on into each other are smoothed as one. A curve passes at most
/// one vertex in each of the rounds, which share the smoothing among them.
void smooth(Network& network, double scale, int rounds, Progress& progress);

} // namespace devseg::curves
