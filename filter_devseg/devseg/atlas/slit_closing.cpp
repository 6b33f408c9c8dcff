#include "devseg/atlas/slit_closing.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

#include "devseg/mesh/angle_defects.h"

namespace devseg::atlas {

std::vector<Index> cut_edges_at_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    std::vector<Index> edges(mesh.points.size(), 0);
    for (Index h = 0; h < mesh.half_edge_count(); ++h)
        if (mesh.twin[at(h)] > h && seam[at(h)] != 0) {
            ++edges[at(mesh.origin(h))];
            ++edges[at(mesh.target(h))];
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
    const auto cut_edge = [&](Index v) {
        Index cut = -1;
        mesh::visit_star(mesh, leaving[at(v)], [&](Index h) { cut = seam[at(h)] != 0 ? h : cut; });
        return cut;
    };
    const auto offer = [&](Index v) {
        if (boundary[at(v)] != 0 || edges[at(v)] != 1)
            return;
        const Index h = cut_edge(v);
        const Index other = mesh.target(h);
        if (boundary[at(other)] == 0 && edges[at(other)] == 1)
            return; // the last cut of a closed chart
        tips.emplace(spent[at(v)] + defect[at(v)] * mesh.edge_length(h), v);
    };
    for (Index v = 0; v < mesh.vertex_count(); ++v)
        offer(v);
    ClosedSlits result;
    while (!tips.empty()) {
        const auto [total, v] = tips.top();
        tips.pop();
        if (total > threshold)
            break;
        const Index h = cut_edge(v);
        const Index other = mesh.target(h);
        if (boundary[at(other)] == 0 && edges[at(other)] == 1)
            continue;
        seam[at(h)] = seam[at(mesh.twin[at(h)])] = 0;
        edges[at(v)] = 0;
        --edges[at(other)];
        defect[at(other)] += defect[at(v)];
        spent[at(other)] += total;
        ++result.closed_edges;
        result.cost = std::max(result.cost, total);
        offer(other);
    }
    return result;
}

} // namespace devseg::atlas
