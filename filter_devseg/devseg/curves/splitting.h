// Faces split along curves: the curves become seams of a finer mesh.
#pragma once

#include "devseg/base/progress.h"
#include "devseg/curves/network.h"
#include "devseg/mesh/refinement.h"

namespace devseg::curves {

struct SplitMesh {
    mesh::Refinement refinement;
    atlas::ChartMap charts;    // of the finer mesh, with the labels that the charts had
    std::vector<Index> failed; // curves that cannot be cut soundly; all else is void then
};

/// Snaps crossings to vertices that they nearly touch, which changes the network, and splits the
/// faces. `charts`: those that the network was made of.
SplitMesh split_along(Network& network, const atlas::ChartMap& charts, const Progress& progress);

} // namespace devseg::curves
