#include "devseg/methods/plush/seam_paths.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "devseg/methods/plush/seam_guides.h"

namespace devseg::plush {

namespace {
constexpr double least_weight = 1e-4; // so that paths stay short where a term vanishes
constexpr double stray_share = 0.95;  // of a weight: what goes where seams look natural
constexpr double shared = 0.25;       // factor of edges that are seams already
} // namespace

SeamWeights seam_weights(const Mesh& mesh, const SeamWeightOptions& options,
                         const std::vector<double>& curvature, const Skeleton& skeleton,
                         const BoneWeights& bones, const Progress& progress) {
    const std::vector<EdgeShape> shapes = edge_shapes(mesh, progress);
    double longest = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        longest = std::max(longest, mesh.edge_length(h));
    SeamWeights result;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index a = std::min(mesh.origin(h), mesh.target(h));
        const Index b = std::max(mesh.origin(h), mesh.target(h));
        double along = 1.0;
        if (!skeleton.empty()) {
            const Vec3& normal = shapes[h].normal;
            const SkeletonDirection bone = skeleton_direction(skeleton, bones, a, b, normal);
            const Vec3 edge = mesh.points[b] - mesh.points[a];
            const Vec3 lying = (edge - edge.dot(normal) * normal).stableNormalized();
            along = 1.0 - bone.agreement * std::abs(lying.dot(bone.direction));
        }
        const double curved = 1.0 / (1.0 + std::abs(curvature[a]) + std::abs(curvature[b]));
        result.stray.push_back(straying(along, shapes[h].bend));
        result.weight.push_back(
            (1.0 - stray_share + stray_share * result.stray.back()) *
            std::max(least_weight, std::pow(mesh.edge_length(h) / longest, options.geodesic) *
                                       std::pow(std::max(0.0, along), options.skeleton) *
                                       std::pow(curved, options.curvature)));
    }
    return result;
}

PathTree shortest_paths(const VertexGraph& graph, const std::vector<double>& weight,
                        const std::vector<Index>& sources, const Progress& progress,
                        const std::vector<std::uint8_t>& may_enter,
                        const std::vector<std::uint8_t>& is_goal) {
    const std::size_t count = graph.begin.size() - 1;
    PathTree tree;
    tree.distance.assign(count, infinite);
    tree.half_edge.assign(count, -1);
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    for (const Vertex v : sources) {
        tree.distance[v] = 0.0;
        queue.emplace(0.0, v);
    }
    Heartbeat beat(progress);
    while (!queue.empty()) {
        beat();
        const auto [distance, v] = queue.top();
        queue.pop();
        if (distance > tree.distance[v] || (distance > 0.0 && !is_goal.empty() && is_goal[v] != 0))
            continue;
        for (Index i = graph.begin[v]; i < graph.begin[at(v) + 1]; ++i) {
            const Index u = graph.vertex[i];
            const double next = distance + weight[graph.half_edge[i]];
            if (!(next < tree.distance[u]) || (!may_enter.empty() && may_enter[u] == 0))
                continue;
            tree.distance[u] = next;
            tree.half_edge[u] = graph.half_edge[i];
            queue.emplace(next, u);
        }
    }
    return tree;
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
            cost[h] *= shared;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        progress.update(static_cast<double>(i) / static_cast<double>(ends.size()));
        const PathTree tree = shortest_paths(graph, cost, {ends[i]}, progress);
        for (std::size_t j = i + 1; j < ends.size(); ++j)
            for (const HalfEdge h : trace_path(mesh, tree, ends[j])) {
                if (seam[h] == 0)
                    for (const HalfEdge side : {h, mesh.twin[h]})
                        if (side >= 0)
                            cost[side] = shared * weight[side];
                mark(mesh, h, 1, seam);
            }
    }
}

} // namespace devseg::plush
