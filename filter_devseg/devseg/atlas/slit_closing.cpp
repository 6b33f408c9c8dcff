#include "devseg/atlas/slit_closing.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

#include "devseg/atlas/holes.h"
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

namespace {

// A run of cuts inside a chart, between two vertices where it meets other cuts or a boundary.
struct Slit {
    double length = 0.0;
    double cost = 0.0; // of the vertices between its ends
    std::vector<HalfEdge> edges;
};

class SlitFinder {
public:
    SlitFinder(const Mesh& mesh, const std::vector<double>& cost, const ChartMap& charts)
        : mesh_(mesh), cost_(cost), charts_(charts),
          cuts_(cut_edges_at_vertices(mesh, charts.seam)),
          boundary_(mesh::boundary_vertices(mesh)) {}

    // Without those that end at a tip.
    std::vector<Slit> find() const {
        std::vector<Slit> slits;
        for (const HalfEdge h : mesh_.all_half_edges()) {
            if (!is_slit(h) || !is_end(mesh_.origin(h)) || is_tip(mesh_.origin(h)))
                continue;
            Slit slit = follow(h);
            const HalfEdge last = slit.edges.back();
            // Each is found from both ends.
            if (!is_tip(mesh_.target(last)) && h < mesh_.twin[last])
                slits.push_back(std::move(slit));
        }
        std::stable_sort(slits.begin(), slits.end(),
                         [](const Slit& a, const Slit& b) { return a.length > b.length; });
        return slits;
    }

private:
    bool is_slit(HalfEdge h) const {
        return mesh_.twin[h] >= 0 && charts_.seam[h] != 0 &&
               charts_.chart[face_of(h)] == charts_.chart[mesh_.across(h)];
    }
    bool is_tip(Vertex v) const { return boundary_[v] == 0 && cuts_[v] == 1; }
    bool is_end(Vertex v) const { return boundary_[v] != 0 || cuts_[v] != 2; }

    Slit follow(HalfEdge h) const {
        Slit slit;
        while (true) {
            slit.edges.push_back(h);
            slit.length += mesh_.edge_length(h);
            const Vertex v = mesh_.target(h);
            if (is_end(v))
                return slit;
            slit.cost += cost_[v];
            const HalfEdge back = mesh_.twin[h];
            mesh::visit_star(mesh_, back, [&](HalfEdge k) {
                if (k != back && charts_.seam[k] != 0)
                    h = k;
            });
        }
    }

    const Mesh& mesh_;
    const std::vector<double>& cost_;
    const ChartMap& charts_;
    std::vector<Index> cuts_;
    std::vector<std::uint8_t> boundary_;
};

} // namespace

Index close_slits_to_holes(const Mesh& mesh, const std::vector<double>& cost, double threshold,
                           ChartMap& charts) {
    const Buckets<Index> groups = group_faces(charts);
    Index closed = 0;
    for (const Slit& slit : SlitFinder(mesh, cost, charts).find()) {
        if (slit.cost * slit.length > threshold)
            continue;
        const auto mark = [&](std::uint8_t value) {
            for (const HalfEdge h : slit.edges)
                charts.seam[h] = charts.seam[mesh.twin[h]] = value;
        };
        mark(0);
        const Span<Index> faces = groups[charts.chart[face_of(slit.edges.front())]];
        if (is_sound(mesh, extract_surface(mesh, {faces.begin(), faces.end()}, charts.seam)))
            closed += static_cast<Index>(slit.edges.size());
        else
            mark(1);
    }
    return closed;
}

} // namespace devseg::atlas
