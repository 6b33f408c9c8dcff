// Joining the boundary loops of a chart by short cuts.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::atlas {

/// Half-edges (local, one for each edge) of cuts that join all boundary loops into one. Starting
/// from the longest loop, the nearest loop is joined by a shortest path to all that is joined
/// already, cuts included (Prim's algorithm with paths).
std::vector<Index> join_loops(const Mesh& mesh, const ChartSurface& surface,
                              const Progress& progress);

/// Outgoing half-edges of each vertex and, at boundary vertices, the incoming boundary half-edge:
/// what it takes to visit every edge at a vertex.
class VertexEdges {
public:
    explicit VertexEdges(const ChartSurface& surface);
    const Index* first(Vertex v) const { return edges_.data() + begin_[v]; }
    const Index* last(Vertex v) const { return edges_.data() + begin_[at(v) + 1]; }

private:
    std::vector<Index> begin_;
    std::vector<Index> edges_;
};

double loop_length(const Mesh& mesh, const ChartSurface& surface, const std::vector<Index>& loop);

} // namespace devseg::atlas
