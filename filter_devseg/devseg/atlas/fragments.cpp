#include "devseg/atlas/fragments.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "devseg/atlas/charts.h"
#include "devseg/graph/unions.h"

namespace devseg::atlas {

namespace {

constexpr int tooth_rounds = 12; // of taking teeth away, one behind the other

// The pieces as a graph: their areas, and the lengths of their common borders.
struct PieceGraph {
    std::vector<double> area;
    std::vector<std::map<Index, double>> border;
};

PieceGraph build_graph(const Mesh& mesh, const ChartMap& pieces) {
    PieceGraph graph;
    graph.area.assign(at(pieces.count), 0.0);
    graph.border.resize(at(pieces.count));
    for (const Face f : mesh.all_faces())
        graph.area[pieces.chart[f]] += mesh.face_areas[f];
    for (const HalfEdge h : mesh.all_half_edges())
        if (pieces.seam[h] != 0)
            graph.border[pieces.chart[face_of(h)]][pieces.chart[mesh.across(h)]] +=
                mesh.edge_length(h);
    return graph;
}

// −1 = none.
Index longest_neighbour(const PieceGraph& graph, Index piece) {
    const std::map<Index, double>& border = graph.border[piece];
    const auto longest =
        std::max_element(border.begin(), border.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    return longest == border.end() ? -1 : longest->first;
}

} // namespace

std::vector<Index> absorb_fragments(const Mesh& mesh, const std::vector<Index>& label,
                                    double share) {
    ChartMap pieces = make_chart_map(mesh, label, {}, false);
    PieceGraph graph = build_graph(mesh, pieces);
    const double limit = share * mesh.total_area;
    std::set<std::pair<double, Index>> small; // by area, then by number
    for (Index p = 0; p < pieces.count; ++p)
        if (graph.area[p] < limit)
            small.emplace(graph.area[p], p);
    graph::Unions owner(at(pieces.count));
    while (!small.empty()) {
        const Index piece = small.begin()->second;
        small.erase(small.begin());
        const Index into = longest_neighbour(graph, piece);
        if (into < 0)
            continue;
        owner.join(into, piece);
        const bool was_small = small.erase({graph.area[into], into}) > 0;
        graph.area[into] += graph.area[piece];
        if (was_small && graph.area[into] < limit)
            small.emplace(graph.area[into], into);
        for (const auto& [other, length] : graph.border[piece]) {
            graph.border[other].erase(piece);
            if (other != into) {
                graph.border[other][into] += length;
                graph.border[into][other] += length;
            }
        }
    }
    for (Index& p : pieces.chart)
        p = owner.find(p);
    return make_chart_map(mesh, pieces.chart, {}, false).chart;
}

void remove_teeth(const Mesh& mesh, std::vector<Index>& label) {
    bool changed = true;
    for (int round = 0; round < tooth_rounds && changed; ++round) {
        changed = false;
        for (const Face f : mesh.all_faces()) {
            std::array<Index, 3> other{-1, -1, -1};
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh.twin[h];
                if (twin >= 0 && label[face_of(twin)] != label[f])
                    other[corner_of(h)] = label[face_of(twin)];
            }
            for (std::size_t k = 0; k < 3; ++k)
                if (other[k] >= 0 && other[k] == other[(k + 1) % 3] &&
                    other[(k + 2) % 3] != other[k]) {
                    label[f] = other[k];
                    changed = true;
                    break;
                }
        }
    }
}

} // namespace devseg::atlas
