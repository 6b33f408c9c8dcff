// Seams as chains of edges, which joins close as a whole or in part.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "devseg/methods/dcharts/draft.h"

namespace devseg::dcharts {

using Pair = std::pair<Index, Index>; // of charts, the lower number first, or twice the same

// Seam edges that may be closed together, each by its half-edge with the lower number, and what is
// opened for them inside the chart.
struct Closing {
    Pair charts;
    std::vector<Index> edges;
    std::vector<Index> opened;
};

// Finds the seams: chains of seam edges from node to node. Nodes are vertices where not just two
// seam edges meet, those on the mesh's boundary, and corners of the surface where these count.
class SeamChains {
public:
    SeamChains(const Mesh& mesh, bool keep_corners);

    bool is_corner(Vertex v) const { return corner_[v] == corner; }
    /// #V: not 0 for corners, and for vertices on the boundary.
    const std::vector<std::uint8_t>& corners() const { return corner_; }

    /// Of the draft's borders and cuts, each in the order of its edges. Where it was called before,
    /// only edges that were seams then, or were opened since, are looked at.
    std::vector<Closing> find(const Draft& draft);

    /// Edges that have become seams.
    void open(const std::vector<Index>& edges);

private:
    static constexpr std::uint8_t corner = 2;

    const Mesh& mesh_;
    std::vector<std::uint8_t> corner_; // #V: on the boundary, or a corner
    std::vector<HalfEdge> seams_;      // ascending; all may be seams, and no others are
};

/// The vertex at which an edge follows another one.
Vertex vertex_between(const Mesh& mesh, HalfEdge h, HalfEdge k);

/// A chain that ends where it begins, as the border all around a chart, then begins at the first
/// vertex on it at which it may, if there is one. Other chains stay as they are.
void begin_loop_at(const Mesh& mesh, const std::function<bool(Vertex)>& may_begin,
                   std::vector<Index>& edges);

/// What the closing leaves of the border between its two charts, a half-edge for each edge.
std::vector<HalfEdge> left_border(const Mesh& mesh, const Draft& draft, const Closing& closing);

} // namespace devseg::dcharts
