#include "devseg/atlas/slit_closing.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

#include "devseg/mesh/angle_defects.h"

namespace devseg::atlas {

std::vector<Index> cut_edges_at_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    std::vector<Index> edges(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h && seam[h] != 0) {
            ++edges[mesh.origin(h)];
            ++edges[mesh.target(h)];
        }
    return edges;
}

ClosedSlits close_slits(const Mesh& mesh, const std::vector<double>& cost, double threshold,
                        std::vector<std::uint8_t>& seam) {
    const std::vector<Index> leaving = mesh::leaving_half_edges(mesh);
    const std::vector<std::uint8_t> boundary = mesh::boundary_vertices(mesh);
    std::vector<Index> edges = cut_edges_at_vertices(mesh, seam);
    std::vector<double> defect = cost;                  // with all that was closed up to here
    std::vector<double> spent(mesh.points.size(), 0.0); // E_s of what was closed up to here
    std::priority_queue<std::tuple<double, Index>, std::vector<std::tuple<double, Index>>,
                        std::greater<>>
        tips;
    const auto cut_edge = [&](Vertex v) {
        HalfEdge cut;
        mesh::visit_star(mesh, leaving[v], [&](HalfEdge h) { cut = seam[h] != 0 ? h : cut; });
        return cut;
    };
    const auto offer = [&](Vertex v) {
        if (boundary[v] != 0 || edges[v] != 1)
            return;
        const HalfEdge h = cut_edge(v);
        const Index other = mesh.target(h);
        if (boundary[other] == 0 && edges[other] == 1)
            return; // the last cut of a closed chart
        tips.emplace(spent[v] + defect[v] * mesh.edge_length(h), v);
    };
    for (const Vertex v : mesh.all_vertices())
        offer(v);
    ClosedSlits result;
    while (!tips.empty()) {
        const auto [total, v] = tips.top();
        tips.pop();
        if (total > threshold)
            break;
        const HalfEdge h = cut_edge(v);
        const Index other = mesh.target(h);
        if (boundary[other] == 0 && edges[other] == 1)
            continue;
        seam[h] = seam[mesh.twin[h]] = 0;
        edges[v] = 0;
        --edges[other];
        defect[other] += defect[v];
        spent[other] += total;
        ++result.closed_edges;
        result.cost = std::max(result.cost, total);
        offer(other);
    }
    return result;
}

} // namespace devseg::atlas
