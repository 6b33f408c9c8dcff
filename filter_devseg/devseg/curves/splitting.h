// Faces split along curves: the curves become seams of a finer mesh.
#pragma once

#include <utility>

#include "devseg/base/progress.h"
#include "devseg/curves/network.h"
#include "devseg/mesh/refinement.h"

namespace devseg::curves {

struct Failure {
    Index curve;
    Index face; // of the old mesh, where; −1 for all of the curve

    bool operator<(const Failure& other) const {
        return std::pair(curve, face) < std::pair(other.curve, other.face);
    }
    bool operator==(const Failure& other) const {
        return curve == other.curve && face == other.face;
    }
};

struct SplitMesh {
    mesh::Refinement refinement;
    atlas::ChartMap charts;      // of the finer mesh, with the labels that the charts had
    std::vector<Failure> failed; // what cannot be cut soundly; all else is void then
};

/// Snaps crossings to vertices that they nearly touch, which changes the network, and splits the
/// faces. `charts`: those that the network was made of.
SplitMesh split_along(Network& network, const atlas::ChartMap& charts, const Progress& progress);

} // namespace devseg::curves
