// Vertices at which seams take up the curvature of the surface, which is all in the vertices of a
// mesh: beside a seam it would stretch the chart.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::curves {

/// How free a seam is.
enum class Firmness : std::uint8_t {
    free,   // a smooth curve
    near,   // the same, through those of its vertices that are curved
    nearer, // through less curved ones as well
    held,   // stays on its edges
};

class CurvedVertices {
public:
    /// `firmness` (3 #F): of each seam edge, both half-edges.
    CurvedVertices(const Mesh& mesh, const std::vector<Firmness>& firmness);

    /// So curved that seams and junctions never leave it.
    bool keeps_seams(Vertex v) const;
    /// Curved enough for seams nearby to go back to it.
    bool draws_seams(Vertex v) const;

private:
    std::vector<double> defect_;     // #V: its magnitude, radians
    std::vector<Firmness> firmness_; // #V: of the firmest seam nearby
};

} // namespace devseg::curves
