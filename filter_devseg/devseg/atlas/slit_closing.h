// Slits closed like zippers, from their tips, where the paper bears it [TTY15, section 3.2.4].
//
// References
//   [TTY15] K. Takahashi, T. Tachi, Y. Yamaguchi: Mesh Approximation for Generating Development
//   with
//           Creases and Slits. Journal for Geometry and Graphics 19(1), 2015.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"

namespace devseg::atlas {

struct ClosedSlits {
    Index closed_edges = 0;
    double cost = 0.0; // the largest that was accepted
};

/// Takes marks off `seam` (3 #F, symmetric). A tip is an inner vertex of the mesh with one cut
/// edge. Closing its edge puts the tip inside the chart, and the other end becomes the next tip.
/// That costs E_s [TTY15, equation 6]: the sum over the vertices that come inside of `cost` (#V,
/// radians) times the length of the closed slit from there on, which is about the width of the gap
/// that the paper has to bridge. Where two closed branches meet, their sums add up. Closes while
/// E_s is at most `threshold` (internal units), always the slit with the least cost. Charts stay
/// disks.
ClosedSlits close_slits(const Mesh& mesh, const std::vector<double>& cost, double threshold,
                        std::vector<std::uint8_t>& seam);

/// Takes marks off slits that end on loops at both ends, the longest first, where the chart is
/// sound without them (see holes.h): they only led to holes that lie flat. The sum of `cost` over
/// the vertices that come inside, times the slit's length, is at most `threshold`, as above.
/// Returns the number of closed edges.
Index close_slits_to_holes(const Mesh& mesh, const std::vector<double>& cost, double threshold,
                           ChartMap& charts);

/// Cut edges at each vertex (#V); the mesh's own boundary does not count.
std::vector<Index> cut_edges_at_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& seam);

} // namespace devseg::atlas
