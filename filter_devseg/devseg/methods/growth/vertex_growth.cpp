#include "devseg/methods/growth/vertex_growth.h"

#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "devseg/mesh/angle_defects.h"

namespace devseg::growth {

VertexGrowth::VertexGrowth(const Mesh& mesh, std::vector<double> cost)
    : mesh_(mesh), cost_(std::move(cost)), leaving_(mesh::leaving_half_edges(mesh)),
      boundary_(mesh::boundary_vertices(mesh)) {}

void VertexGrowth::start(std::size_t charts) {
    state_.inside.assign(mesh_.points.size(), -1);
    state_.chart.assign(mesh_.faces.size(), -1);
    state_.face_count.assign(charts, 0);
    state_.cost.assign(charts, 0.0);
    heaps_.resize(charts);
    for (CandidateHeap& heap : heaps_)
        heap.clear();
}

bool VertexGrowth::is_free(Vertex v) const {
    bool free = leaving_[v] >= 0;
    if (free)
        mesh::visit_star(mesh_, leaving_[v],
                         [&](HalfEdge h) { free = free && state_.chart[face_of(h)] < 0; });
    return free;
}

// A chart stays a disk if the vertex has one fan of the chart's faces and a gap of free ones. A
// vertex without a gap is surrounded by the chart: it is the tip of a slit, and stays one.
bool VertexGrowth::can_take(Vertex v, Index c) const {
    if (state_.inside[v] >= 0 || !std::isfinite(cost_[v]))
        return false;
    int fans = 0;
    bool gap = false;
    bool foreign = false;
    bool first = true;
    bool first_glued = false;
    bool before = false; // whether the edge before hangs together
    const auto visit_edge = [&](bool glued) {
        if (first)
            first_glued = glued;
        else if (glued && !before)
            ++fans;
        first = false;
        before = glued;
    };
    const auto visit = [&](HalfEdge h) {
        const Index chart = state_.chart[face_of(h)];
        const bool from = state_.inside[mesh_.target(h)] == c;
        const bool to = state_.inside[mesh_.origin(Mesh::previous(h))] == c;
        visit_edge(from);
        if (!from && !to) {
            gap = gap || chart < 0;
            foreign = foreign || chart >= 0;
        }
        if (boundary_[v] != 0 && mesh_.twin[Mesh::previous(h)] < 0)
            visit_edge(to);
    };
    mesh::visit_star(mesh_, leaving_[v], visit);
    // Around an inner vertex the first edge comes after the last one; on the boundary, after none.
    if (first_glued && (boundary_[v] != 0 || !before || fans == 0))
        ++fans;
    return fans == 1 && gap && !foreign;
}

void VertexGrowth::take(Vertex v, Index c, float distance) {
    state_.inside[v] = c;
    state_.cost[c] += cost_[v];
    mesh::visit_star(mesh_, leaving_[v], [&](HalfEdge h) {
        if (state_.chart[face_of(h)] < 0) {
            state_.chart[face_of(h)] = c;
            ++state_.face_count[c];
        }
    });
    const auto offer = [&](Vertex u, HalfEdge along) {
        const float d = distance + static_cast<float>(mesh_.edge_length(along));
        if (state_.inside[u] < 0)
            heaps_[c].push({static_cast<float>(cost_[u]), d, u});
    };
    mesh::visit_star(mesh_, leaving_[v], [&](HalfEdge h) {
        offer(mesh_.target(h), h);
        const HalfEdge arriving = Mesh::previous(h);
        if (mesh_.twin[arriving] < 0)
            offer(mesh_.origin(arriving), arriving);
    });
}

// The best candidate of chart c, −1 for none. A vertex that cannot be taken now is dropped: it is
// offered again when a neighbour is taken, and nothing else can make it fit.
Index VertexGrowth::best(Index c) {
    CandidateHeap& heap = heaps_[c];
    while (!heap.empty() && !can_take(heap.top().face, c))
        heap.pop();
    return heap.empty() ? -1 : heap.top().face;
}

void VertexGrowth::take_best(Index c) {
    const Candidate next = heaps_[c].top();
    heaps_[c].pop();
    take(next.face, c, next.distance);
}

std::vector<Index> VertexGrowth::find_seeds(double threshold, const Progress& progress) {
    start(0);
    std::vector<Index> order(mesh_.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
        return std::make_tuple(boundary_[a], cost_[a]) < std::make_tuple(boundary_[b], cost_[b]);
    });
    std::vector<Index> seeds;
    Heartbeat beat(progress);
    for (const Index seed : order) {
        if (!is_free(seed))
            continue;
        const Index c = static_cast<Index>(seeds.size());
        seeds.push_back(seed);
        heaps_.resize(1);
        heaps_.front().clear();
        heaps_.resize(seeds.size());
        heaps_[c].clear();
        state_.face_count.push_back(0);
        state_.cost.push_back(0.0);
        take(seed, c, 0.0F);
        for (Vertex v = best(c); v >= 0 && !(state_.cost[c] + cost_[v] > threshold); v = best(c)) {
            beat();
            take_best(c);
        }
    }
    return seeds;
}

VertexCharts VertexGrowth::grow(const std::vector<Index>& seeds, const Progress& progress) {
    start(seeds.size());
    const Index count = static_cast<Index>(seeds.size());
    for (Index c = 0; c < count; ++c)
        take(seeds[c], c, 0.0F);
    Tournament<double> tournament(count);
    const auto rank = [&](Index c) { tournament.set(c, best(c) < 0 ? infinite : state_.cost[c]); };
    for (Index c = 0; c < count; ++c)
        rank(c);
    Heartbeat beat(progress);
    while (tournament.key(tournament.winner()) < infinite) {
        beat();
        const Index c = tournament.winner();
        if (best(c) >= 0) // another chart may have come in between
            take_best(c);
        rank(c);
    }
    return state_;
}

atlas::ChartMap adopt_orphans(const Mesh& mesh, const VertexCharts& grown) {
    atlas::ChartMap charts;
    charts.chart = grown.chart;
    charts.count = static_cast<Index>(grown.face_count.size());
    charts.seam.assign(mesh.twin.size(), 1);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index c = grown.chart[face_of(h)];
        if (mesh.twin[h] >= 0 && c >= 0 && c == grown.chart[face_of(mesh.twin[h])] &&
            (grown.inside[mesh.origin(h)] == c || grown.inside[mesh.target(h)] == c))
            charts.seam[h] = 0;
    }
    // The face with the longest share of its border to gain goes first; half-edges of taken faces.
    std::priority_queue<std::pair<double, Index>> offers;
    const auto offer_across = [&](HalfEdge h) {
        const HalfEdge twin = mesh.twin[h];
        if (twin < 0 || charts.chart[face_of(twin)] >= 0)
            return;
        double shared = 0.0;
        double all = 0.0;
        for (const HalfEdge k : half_edges_of(face_of(twin))) {
            all += mesh.edge_length(k);
            if (mesh.twin[k] >= 0 &&
                charts.chart[face_of(mesh.twin[k])] == charts.chart[face_of(h)])
                shared += mesh.edge_length(k);
        }
        // Among the edges to one chart the longest is the best hinge: it counts a little.
        offers.emplace((shared + 1e-3 * mesh.edge_length(h)) / all, -h);
    };
    for (const HalfEdge h : mesh.all_half_edges())
        if (charts.chart[face_of(h)] >= 0)
            offer_across(h);
    while (!offers.empty()) {
        const HalfEdge h = -offers.top().second;
        offers.pop();
        const HalfEdge twin = mesh.twin[h];
        if (charts.chart[face_of(twin)] >= 0)
            continue;
        charts.chart[face_of(twin)] = charts.chart[face_of(h)];
        charts.seam[h] = charts.seam[twin] = 0;
        for (const HalfEdge k : half_edges_of(face_of(twin)))
            offer_across(k);
    }
    return charts;
}

} // namespace devseg::growth
