// Curves on the surface, smoothed by bending.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/curves/curved_vertices.h"
#include "devseg/curves/network.h"
#include "devseg/mesh/mirror_plane.h"

namespace devseg::curves {

struct SmoothingAims {
    double scale;                           // internal units: shorter waves go
    int rounds;                             // which share the smoothing among them
    std::vector<std::uint8_t> alone;        // 3 #F: 1 on edges of curves that have no mirror image
    std::optional<mesh::MirrorPlane> plane; // in which curves become mirror images of each other
};

/// Moves the crossings and junctions of the network until waves shorter than the scale have gone.
/// Curves keep to their sides of each other, of held curves and of nodes; at junctions, the two
/// curves that go on into each other are smoothed as one. Curves go through curved vertices beside
/// them. A curve passes at most one vertex in each round.
void smooth(Network& network, const CurvedVertices& curved, const SmoothingAims& aims,
            Progress& progress);

} // namespace devseg::curves
