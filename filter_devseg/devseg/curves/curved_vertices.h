// Vertices at which seams take up the curvature of the surface, which is all in the vertices of a
// mesh: beside a seam it would stretch the chart.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::curves {

class CurvedVertices {
public:
    /// `firm` (3 #F): 1 on edges near which seams stay at less curved vertices as well.
    CurvedVertices(const Mesh& mesh, const std::vector<std::uint8_t>& firm);

    /// So curved that seams and junctions never leave it.
    bool keeps_seams(Vertex v) const;
    /// Curved enough for seams nearby to go back to it.
    bool draws_seams(Vertex v) const;

private:
    std::vector<double> defect_;     // #V: its magnitude, radians
    std::vector<std::uint8_t> firm_; // #V: 1 near firm seams
};

} // namespace devseg::curves
