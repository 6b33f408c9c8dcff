#include "devseg/methods/t_flooding/balanced_borders.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "devseg/graph/min_cut.h"
#include "devseg/methods/growth/relabelling.h"
#include "devseg/methods/growth/reseed.h"

namespace devseg::t_flooding {

namespace {

// The first price of Gauss area that is tried, as a share of the price of all the difference.
constexpr double first_price = 1.0 / 64.0;

// Strips are at most this many faces wide on each side: the time for their cuts grows much faster
// than their width.
constexpr double strip_steps = 4.0;

// The least share of a strip's width that is tried.
constexpr double narrowest = 0.2;

constexpr double worthwhile = 1.0 - 1e-9; // lower than rounding would explain

using Pair = std::pair<Index, Index>;

class BorderBalancer {
public:
    BorderBalancer(const Mesh& mesh, const metrics::GaussAreas& areas, const BorderBalance& options,
                   Index count, std::vector<Index>& chart)
        : mesh_(mesh), areas_(areas), options_(options), chart_(chart), count_(count),
          crease_(metrics::long_creases(mesh, areas.crease, count)), fixed_(mesh.faces.size(), 0),
          border_distance_(mesh), node_(mesh.faces.size(), -1), relabelling_(mesh, chart),
          changes_(at(count), 0) {
        std::vector<Index> valence(mesh.points.size(), 0); // faces of each vertex
        for (const HalfEdge h : mesh.all_half_edges()) {
            border_cost_.push_back(static_cast<float>(
                mesh.edge_length(h) * (areas.crease[h] != 0 ? options.crease_cost : 1.0)));
            const HalfEdge twin = mesh.twin[h];
            step_.push_back(
                twin < 0 ? 0.0F
                         : static_cast<float>(
                               (mesh.face_centers[h / 3] - mesh.face_centers[twin / 3]).norm()));
            ++valence[mesh.origin(h)];
        }
        face_area_ = areas.face;
        for (const HalfEdge h : mesh.all_half_edges())
            face_area_[h / 3] +=
                0.5 * areas.edge[h] + areas.vertex[mesh.origin(h)] / valence[mesh.origin(h)];
        double steps = 0.0;
        for (const float step : step_)
            steps += step;
        widest_ = static_cast<float>(strip_steps * steps / static_cast<double>(step_.size()));
        const double average = areas.total / count;
        if (average > 0.0)
            stiffness_ =
                options.stiffness * std::sqrt(mesh.total_area / count) / (average * average);
    }

    void sweep(Progress& progress) {
        fix_creases();
        deepest_ = border_distance_.farthest_faces(
            chart_, std::vector<Index>(at(count_), -1), [&](HalfEdge h) { return step_[h]; },
            progress);
        gauss_area_ = metrics::chart_gauss_areas(mesh_, areas_, chart_, count_);
        std::vector<std::pair<Pair, Index>> borders; // the charts on both sides, half-edge
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin >= 0 && chart_[h / 3] < chart_[twin / 3])
                borders.push_back({{chart_[h / 3], chart_[twin / 3]}, h});
        }
        std::sort(borders.begin(), borders.end());
        for (std::size_t i = 0; i < borders.size();) {
            std::vector<Index> edges;
            const Pair pair = borders[i].first;
            for (; i < borders.size() && borders[i].first == pair; ++i)
                edges.push_back(borders[i].second);
            // Nothing new since a try that failed: it would fail again.
            const int now = changes_[pair.first] + changes_[pair.second];
            const auto tried = settled_.find(pair);
            if (tried != settled_.end() && tried->second == now)
                continue;
            if (move_border(pair, edges)) {
                ++changes_[pair.first];
                ++changes_[pair.second];
            } else {
                settled_[pair] = now;
            }
            progress.update(0.0);
        }
    }

private:
    // Faces at borders that follow a long crease stay where they are.
    void fix_creases() {
        std::fill(fixed_.begin(), fixed_.end(), 0);
        for (const HalfEdge h : mesh_.all_half_edges())
            if (crease_[h] != 0 && chart_[h / 3] != chart_[mesh_.twin[h] / 3])
                fixed_[h / 3] = 1;
    }

    // Faces on both sides that are near this border; the deepest face of a chart stays.
    std::vector<Index> strip(const Pair& pair, const std::vector<Index>& edges, double share) {
        std::vector<Index> faces;
        std::vector<std::pair<float, Index>> front; // a heap of (distance, face)
        const float reach = static_cast<float>(share * options_.reach);
        const float widest = static_cast<float>(share) * widest_;
        const auto offer = [&](Face f, float d) {
            const std::size_t c = at(chart_[f]);
            if (fixed_[f] != 0 || f == deepest_.face[c] ||
                d > std::min(reach * deepest_.distance[c], widest))
                return;
            front.emplace_back(-d, f);
            std::push_heap(front.begin(), front.end());
        };
        for (const HalfEdge h : edges) {
            const HalfEdge twin = mesh_.twin[h];
            // Other borders that moved in this sweep may have given a side to a third chart.
            if (chart_[h / 3] != pair.first || chart_[twin / 3] != pair.second)
                continue;
            offer(h / 3, 0.0F);
            offer(twin / 3, 0.0F);
        }
        while (!front.empty()) {
            std::pop_heap(front.begin(), front.end());
            const auto [d, f] = front.back();
            front.pop_back();
            if (node_[f] >= 0)
                continue;
            node_[f] = static_cast<Index>(faces.size());
            faces.push_back(f);
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin >= 0 && node_[twin / 3] < 0 && chart_[twin / 3] == chart_[f])
                    offer(twin / 3, step_[h] - d);
            }
        }
        return faces;
    }

    // One way to part the strip: its sides, what the border in it costs, and the Gauss area that
    // goes from the first chart to the second.
    struct Parting {
        std::vector<graph::CutSide> side;
        double length = 0.0;
        double moved = 0.0;
    };

    // [length + κ/2 Σ area²] of the two charts after `moved` has gone from a to b.
    double energy(const Pair& pair, const Parting& parting) const {
        const double a = gauss_area_[pair.first] - parting.moved;
        const double b = gauss_area_[pair.second] + parting.moved;
        return parting.length + 0.5 * stiffness_ * (a * a + b * b);
    }
    double difference(const Pair& pair, const Parting& parting) const {
        return gauss_area_[pair.first] - gauss_area_[pair.second] - 2.0 * parting.moved;
    }

    // Border of a parting: links of the strip's faces to each other and to the charts' cores.
    template <class Visit>
    void visit_links(const Pair& pair, const std::vector<Index>& faces, Visit visit) const {
        const Index core_a = static_cast<Index>(faces.size());
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0)
                    continue;
                const Index other = node_[twin / 3];
                const Index c = chart_[twin / 3];
                if (other >= 0 && h < twin)
                    visit(node_[f], other, border_cost_[h]);
                else if (other < 0 && c == pair.first)
                    visit(node_[f], core_a, border_cost_[h]);
                else if (other < 0 && c == pair.second)
                    visit(node_[f], core_a + 1, border_cost_[h]);
            }
    }

    void evaluate(const Pair& pair, const std::vector<Index>& faces, Parting& parting) const {
        parting.length = parting.moved = 0.0;
        visit_links(pair, faces, [&](Index a, Index b, float cost) {
            if (parting.side[a] != parting.side[b])
                parting.length += cost;
        });
        for (std::size_t i = 0; i < faces.size(); ++i) {
            const bool was_a = chart_[faces[i]] == pair.first;
            const bool is_a = parting.side[i] == graph::CutSide::source;
            parting.moved +=
                (was_a ? 1 : 0) * face_area_[faces[i]] - (is_a ? 1 : 0) * face_area_[faces[i]];
        }
    }

    Parting solve(const Pair& pair, const std::vector<Index>& faces, graph::MinCut& cut) const {
        Parting result;
        result.side = cut.solve();
        drop_islands(pair, faces, graph::CutSide::source, result.side);
        drop_islands(pair, faces, graph::CutSide::sink, result.side);
        evaluate(pair, faces, result);
        return result;
    }

    // Faces of the strip that hang together with their chart's core only through the other chart
    // go to that one. A price on Gauss area makes islands of single curved faces.
    void drop_islands(const Pair& pair, const std::vector<Index>& faces, graph::CutSide which,
                      std::vector<graph::CutSide>& side) const {
        const Index own = which == graph::CutSide::source ? pair.first : pair.second;
        std::vector<std::uint8_t> held(faces.size(), 0);
        std::vector<Index> stack;
        const auto hold = [&](std::size_t i) {
            if (held[i] == 0 && side[i] == which) {
                held[i] = 1;
                stack.push_back(faces[i]);
            }
        };
        const auto for_neighbours = [&](Face f, auto visit) {
            for (const HalfEdge h : half_edges_of(f))
                if (mesh_.twin[h] >= 0)
                    visit(mesh_.twin[h] / 3);
        };
        for (std::size_t i = 0; i < faces.size(); ++i)
            for_neighbours(faces[i], [&](Index g) {
                if (node_[g] < 0 && chart_[g] == own)
                    hold(i);
            });
        while (!stack.empty()) {
            const Face f = stack.back();
            stack.pop_back();
            for_neighbours(f, [&](Index g) {
                if (node_[g] >= 0)
                    hold(at(node_[g]));
            });
        }
        for (std::size_t i = 0; i < faces.size(); ++i)
            if (held[i] == 0 && side[i] == which)
                side[i] =
                    which == graph::CutSide::source ? graph::CutSide::sink : graph::CutSide::source;
    }

    // The least cut for growing prices of Gauss area, from none to one that agrees with the
    // difference of the charts that is left.
    Parting best_parting(const Pair& pair, const std::vector<Index>& faces) {
        const Index core_a = static_cast<Index>(faces.size());
        std::vector<graph::CutSide> sides(faces.size() + 2, graph::CutSide::open);
        sides[core_a] = graph::CutSide::source;
        sides[at(core_a) + 1] = graph::CutSide::sink;
        graph::MinCut cut(std::move(sides));
        visit_links(pair, faces, [&](Index a, Index b, float cost) { cut.link(a, b, cost); });
        Parting best = solve(pair, faces, cut);
        double due = stiffness_ * difference(pair, best);
        const Index core = due > 0.0 ? core_a + 1 : core_a;
        std::vector<Index> links(faces.size());
        for (std::size_t i = 0; i < faces.size(); ++i)
            links[i] = cut.link(static_cast<Index>(i), core, 0.0);
        // The price that served last time is near; otherwise a small share of the whole.
        double& last = last_price_[pair];
        double price = 0.0;
        double next = std::abs(due) * first_price;
        if (last > next && last < std::abs(due))
            next = 0.5 * last;
        for (; next < std::abs(due); next *= 2.0) {
            for (std::size_t i = 0; i < faces.size(); ++i)
                cut.raise(links[i], (next - price) * face_area_[faces[i]]);
            price = next;
            Parting trial = solve(pair, faces, cut);
            const double left = stiffness_ * difference(pair, trial);
            if (energy(pair, trial) < energy(pair, best))
                best = std::move(trial);
            if (std::abs(left) < price || (left > 0.0) != (due > 0.0))
                break;
        }
        last = price;
        return best;
    }

    // A wide strip may take a chart apart where a narrow one does not.
    bool move_border(const Pair& pair, const std::vector<Index>& edges) {
        bool improves = true;
        for (double share = 1.0; improves && share > narrowest; share *= 0.5) {
            const std::vector<Index> faces = strip(pair, edges, share);
            Parting now;
            now.side.assign(faces.size() + 2, graph::CutSide::source);
            now.side.back() = graph::CutSide::sink;
            for (std::size_t i = 0; i < faces.size(); ++i)
                if (chart_[faces[i]] == pair.second)
                    now.side[i] = graph::CutSide::sink;
            evaluate(pair, faces, now);
            const Parting best = best_parting(pair, faces);
            improves = energy(pair, best) < energy(pair, now) * worthwhile;
            for (const Face f : faces)
                node_[f] = -1;
            if (improves && apply(pair, faces, best))
                return true;
        }
        return false;
    }

    // A border may make a chart simpler, but not take it apart. Anchors stay where they are.
    bool apply(const Pair& pair, const std::vector<Index>& faces, const Parting& parting) {
        growth::NewLabels labels;
        for (std::size_t i = 0; i < faces.size(); ++i)
            labels.emplace_back(faces[i], parting.side[i] == graph::CutSide::source ? pair.first
                                                                                    : pair.second);
        const Face a = deepest_.face[pair.first];
        const Face b = deepest_.face[pair.second];
        if (!relabelling_.take({{{pair.first, a, a}, {pair.second, b, b}}}, labels, {1.0, true}))
            return false;
        gauss_area_[pair.first] -= parting.moved;
        gauss_area_[pair.second] += parting.moved;
        return true;
    }

    const Mesh& mesh_;
    const metrics::GaussAreas& areas_;
    const BorderBalance& options_;
    std::vector<Index>& chart_;
    Index count_;
    float widest_ = 0.0F;              // bound of the strips' width: their cuts cost time
    std::vector<double> face_area_;    // #F: Gauss area with its share of edges and corners
    std::vector<double> gauss_area_;   // of each chart
    double stiffness_ = 0.0;           // κ: length per Gauss area squared
    std::vector<std::uint8_t> crease_; // 3 #F: long creases
    std::vector<std::uint8_t> fixed_;  // #F: keeps its chart in this sweep
    std::vector<float> border_cost_;   // 3 #F
    std::vector<float> step_;          // 3 #F: distance of the centroids on both sides
    growth::BorderDistance border_distance_;
    growth::FarthestFaces deepest_; // of each chart: stays where it is
    std::vector<Index> node_;       // #F: node in the strip at hand, −1 = none
    growth::Relabelling relabelling_;
    std::vector<int> changes_;    // of each chart: borders moved so far
    std::map<Pair, int> settled_; // changes of both charts when nothing could be gained
    std::map<Pair, double> last_price_;
};

} // namespace

void balance_borders(const Mesh& mesh, const metrics::GaussAreas& areas,
                     const BorderBalance& options, Index count, std::vector<Index>& chart,
                     Progress& progress) {
    BorderBalancer balancer(mesh, areas, options, count, chart);
    for (int sweep = 0; sweep < options.sweeps; ++sweep) {
        progress.update(static_cast<double>(sweep) / options.sweeps);
        balancer.sweep(progress);
    }
}

} // namespace devseg::t_flooding
