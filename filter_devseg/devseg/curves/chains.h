// Curves that are smoothed as one.
#pragma once

#include <utility>
#include <vector>

#include "devseg/curves/network.h"

namespace devseg::curves {

/// One or more curves, each going on into the next.
struct Chain {
    std::vector<std::pair<Index, bool>> links; // curve, forwards
    bool closed = false;
};

/// All curves that cross edges, each in one chain. At a junction the two curves that turn least go
/// on into each other, where they turn little. `scale`: internal units, over which directions are
/// taken.
std::vector<Chain> make_chains(const Network& network, double scale);

} // namespace devseg::curves
