// Charts that grow by vertices: a chart takes a vertex of its border and all faces around it, and
// that vertex is inside the chart from then on [TTY15, section 3.2.1].
//
// References
//   [TTY15] K. Takahashi, T. Tachi, Y. Yamaguchi: Mesh Approximation for Generating Development
//           with Creases and Slits. Journal for Geometry and Graphics 19(1), 2015.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/methods/growth/growth.h"

namespace devseg::growth {

/// What a growth leaves: `inside` (#V) is the chart that a vertex is inside of, `chart` (#F) that
/// of a face; −1 for none. Edges of a chart hang together where one of their vertices is inside of
/// it; all others are cut, which makes slits wherever a chart meets itself.
struct VertexCharts {
    std::vector<Index> inside;
    std::vector<Index> chart;
    std::vector<Index> face_count; // by chart
    std::vector<double> cost;      // by chart: the sum over its inner vertices [TTY15, equation 3]
};

class VertexGrowth {
public:
    /// `cost` (#V) is what a vertex inside of a chart costs, at least 0 [TTY15, equation 2].
    VertexGrowth(const Mesh& mesh, std::vector<double> cost);

    /// Charts one after the other, each from the vertex of least cost whose faces are all free, and
    /// each up to the cost `threshold`. Returns the seeds; every vertex lies in or on a chart then.
    std::vector<Index> find_seeds(double threshold, const Progress& progress);

    /// All charts at the same time, always the one of least cost, until none can grow.
    VertexCharts grow(const std::vector<Index>& seeds, const Progress& progress);

private:
    void start(std::size_t charts);
    bool is_free(Vertex v) const;
    bool can_take(Vertex v, Index c) const;
    void take(Vertex v, Index c, float distance);
    Index best(Index c);
    void take_best(Index c);

    const Mesh& mesh_;
    std::vector<double> cost_;
    std::vector<Index> leaving_;         // #V
    std::vector<std::uint8_t> boundary_; // #V: on the boundary of the mesh
    std::vector<CandidateHeap> heaps_;   // by chart; `face` is a vertex here
    VertexCharts state_;
};

/// Faces that no chart took go to a neighbour, one by one, across one edge: to the one with which
/// the border stays smoothest, which is the longest way round that it shortens most. Returns the
/// charts with their slits.
atlas::ChartMap adopt_orphans(const Mesh& mesh, const VertexCharts& grown);

} // namespace devseg::growth
