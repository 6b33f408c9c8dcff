#include "devseg/methods/plush/seam_paths.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/graph/shortest_paths.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

PathTree shortest_paths(const VertexGraph& graph, const std::vector<double>& weight,
                        const std::vector<Index>& sources, const Progress& progress,
                        const std::vector<std::uint8_t>& may_enter,
                        const std::vector<std::uint8_t>& is_goal) {
    graph::ShortestPaths<> paths(graph.begin.size() - 1);
    for (const Vertex v : sources)
        paths.add_source(v);
    paths.run(
        [&](Vertex v, double distance) {
            if (distance > 0.0 && !is_goal.empty() && is_goal[v] != 0)
                return;
            for (Index i = graph.begin[v]; i < graph.begin[at(v) + 1]; ++i)
                if (may_enter.empty() || may_enter[graph.vertex[i]] != 0)
                    paths.reach(graph.vertex[i], distance + weight[graph.half_edge[i]],
                                graph.half_edge[i]);
        },
        progress);
    return {std::move(paths.distance), std::move(paths.step)};
}

std::vector<Index> trace_path(const Mesh& mesh, const PathTree& tree, Vertex vertex) {
    std::vector<Index> path;
    while (tree.half_edge[vertex] >= 0 && tree.distance[vertex] > 0.0) {
        const HalfEdge h = tree.half_edge[vertex];
        path.push_back(h);
        vertex = mesh.origin(h) == vertex ? mesh.target(h) : mesh.origin(h);
    }
    return path;
}

void add_structural_seams(const Mesh& mesh, const VertexGraph& graph,
                          const std::vector<double>& weight, const std::vector<Index>& ends,
                          SeamMarks& seam, Progress& progress) {
    std::vector<double> cost = weight;
    for (const HalfEdge h : mesh.all_half_edges())
        if (seam[h] != 0)
            cost[h] *= tuning.shared_seam;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        progress.update(static_cast<double>(i) / static_cast<double>(ends.size()));
        const PathTree tree = shortest_paths(graph, cost, {ends[i]}, progress);
        for (std::size_t j = i + 1; j < ends.size(); ++j)
            for (const HalfEdge h : trace_path(mesh, tree, ends[j])) {
                if (seam[h] == 0)
                    for (const HalfEdge side : {h, mesh.twin[h]})
                        if (side >= 0)
                            cost[side] = tuning.shared_seam * weight[side];
                mark(mesh, h, 1, seam);
            }
    }
}

} // namespace devseg::plush
