#include "devseg/methods/t_flooding/balanced_borders.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "devseg/graph/min_cut.h"
#include "devseg/methods/growth/relabelling.h"
#include "devseg/methods/growth/seeds.h"

namespace devseg::t_flooding {

namespace {

struct BalanceTuning {
    // The first price of Gauss area that is tried, as a share of the price of all the difference.
    double first_price = 1.0 / 64.0;
    // Strips are at most this many faces wide on each side: the time for their cuts grows much
    // faster than their width.
    double strip_steps = 4.0;
    // Cost of a border through a facet, over its length: more than any way around.
    double through_facet = 1e6;
};
constexpr BalanceTuning tuning;

using Pair = std::pair<Index, Index>;

// What borders and faces cost: the same in all sweeps.
struct BorderCosts {
    std::vector<float> border;      // 3 #F
    std::vector<float> step;        // 3 #F: distance of the centroids on both sides
    std::vector<double> gauss_area; // #F, with its share of edges and corners
    float widest = 0.0F;            // bound of the strips' width: their cuts cost time
    double stiffness = 0.0;         // κ: length per Gauss area squared
};

BorderCosts measure_costs(const Mesh& mesh, const metrics::GaussAreas& areas,
                          const mesh::Facets& facets, const BorderBalance& options, Index count) {
    BorderCosts costs;
    std::vector<Index> valence(mesh.points.size(), 0); // faces of each vertex
    double steps = 0.0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        const bool is_inside = twin >= 0 && facets.are_one(face_of(h), face_of(twin));
        costs.border.push_back(
            static_cast<float>(mesh.edge_length(h) * (is_inside              ? tuning.through_facet
                                                      : areas.crease[h] != 0 ? options.crease_cost
                                                                             : 1.0)));
        costs.step.push_back(
            twin < 0
                ? 0.0F
                : static_cast<float>(
                      (mesh.face_centers[face_of(h)] - mesh.face_centers[face_of(twin)]).norm()));
        steps += costs.step.back();
        ++valence[mesh.origin(h)];
    }
    costs.gauss_area = areas.face;
    for (const HalfEdge h : mesh.all_half_edges())
        costs.gauss_area[face_of(h)] +=
            0.5 * areas.edge[h] + areas.vertex[mesh.origin(h)] / valence[mesh.origin(h)];
    costs.widest =
        static_cast<float>(tuning.strip_steps * steps / static_cast<double>(costs.step.size()));
    const double average = areas.total / count;
    if (average > 0.0)
        costs.stiffness =
            options.stiffness * std::sqrt(mesh.total_area / count) / (average * average);
    return costs;
}

// One way to part a strip: its sides, what the border in it costs, and the Gauss area that goes
// from the first chart to the second.
struct Parting {
    std::vector<graph::CutSide> side;
    double length = 0.0;
    double moved = 0.0;
};

// The faces near the border of two charts, which may change sides.
class Strip {
public:
    // `node` is −1 for all faces, and will be again; may_move(face, distance from the border).
    template <class MayMove>
    Strip(const Mesh& mesh, const BorderCosts& costs, const std::vector<Index>& chart,
          const Pair& pair, const std::vector<Index>& edges, MayMove may_move,
          std::vector<Index>& node)
        : mesh_(mesh), costs_(costs), chart_(chart), pair_(pair), node_(node) {
        std::vector<std::pair<float, Index>> front; // a heap of (distance, face)
        const auto offer = [&](Face f, float distance) {
            if (!may_move(f, distance))
                return;
            front.emplace_back(-distance, f);
            std::push_heap(front.begin(), front.end());
        };
        for (const HalfEdge h : edges) {
            const HalfEdge twin = mesh.twin[h];
            // Other borders that moved in this sweep may have given a side to a third chart.
            if (chart[face_of(h)] != pair.first || chart[face_of(twin)] != pair.second)
                continue;
            offer(face_of(h), 0.0F);
            offer(face_of(twin), 0.0F);
        }
        while (!front.empty()) {
            std::pop_heap(front.begin(), front.end());
            const auto [d, f] = front.back();
            front.pop_back();
            if (node[f] >= 0)
                continue;
            node[f] = static_cast<Index>(faces_.size());
            faces_.push_back(f);
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh.twin[h];
                if (twin >= 0 && node[face_of(twin)] < 0 && chart[face_of(twin)] == chart[f])
                    offer(face_of(twin), costs.step[h] - d);
            }
        }
    }
    Strip(const Strip&) = delete;
    Strip& operator=(const Strip&) = delete;
    ~Strip() {
        for (const Face f : faces_)
            node_[f] = -1;
    }

    Parting as_it_is() const {
        Parting now;
        now.side.assign(faces_.size() + 2, graph::CutSide::source);
        now.side.back() = graph::CutSide::sink;
        for (std::size_t i = 0; i < faces_.size(); ++i)
            if (chart_[faces_[i]] == pair_.second)
                now.side[i] = graph::CutSide::sink;
        evaluate(now);
        return now;
    }

    // The best of the least cuts for growing prices of Gauss area, from none to one that agrees
    // with the difference of the charts that is left. `area_a` and `area_b` are those of the
    // charts; the price that served last time is near, otherwise a small share of the whole.
    Parting best_parting(double area_a, double area_b, double& last_price) const {
        const Index core_a = static_cast<Index>(faces_.size());
        std::vector<graph::CutSide> sides(faces_.size() + 2, graph::CutSide::open);
        sides[core_a] = graph::CutSide::source;
        sides[at(core_a) + 1] = graph::CutSide::sink;
        graph::MinCut cut(std::move(sides));
        visit_links([&](Index a, Index b, float cost) { cut.link(a, b, cost); });
        const auto due_after = [&](const Parting& parting) {
            return costs_.stiffness * (area_a - area_b - 2.0 * parting.moved);
        };
        Parting best = solve(cut);
        const double due = due_after(best);
        const Index core = due > 0.0 ? core_a + 1 : core_a;
        std::vector<Index> links;
        for (Index i = 0; i < core_a; ++i)
            links.push_back(cut.link(i, core, 0.0));
        double price = 0.0;
        double next = std::abs(due) * tuning.first_price;
        if (last_price > next && last_price < std::abs(due))
            next = 0.5 * last_price;
        for (; next < std::abs(due); next *= 2.0) {
            for (std::size_t i = 0; i < faces_.size(); ++i)
                cut.raise(links[i], (next - price) * costs_.gauss_area[faces_[i]]);
            price = next;
            Parting trial = solve(cut);
            const double left = due_after(trial);
            if (energy(area_a, area_b, trial) < energy(area_a, area_b, best))
                best = std::move(trial);
            if (std::abs(left) < price || (left > 0.0) != (due > 0.0))
                break;
        }
        last_price = price;
        return best;
    }

    // [length + κ/2 Σ area²] of the two charts.
    double energy(double area_a, double area_b, const Parting& parting) const {
        const double a = area_a - parting.moved;
        const double b = area_b + parting.moved;
        return parting.length + 0.5 * costs_.stiffness * (a * a + b * b);
    }

    growth::NewLabels labels(const Parting& parting) const {
        growth::NewLabels result;
        for (std::size_t i = 0; i < faces_.size(); ++i)
            result.emplace_back(
                faces_[i], parting.side[i] == graph::CutSide::source ? pair_.first : pair_.second);
        return result;
    }

private:
    // Border of a parting: links of the strip's faces to each other and to the charts' cores.
    template <class Visit>
    void visit_links(Visit visit) const {
        const Index core_a = static_cast<Index>(faces_.size());
        for (const Face f : faces_)
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0)
                    continue;
                const Index other = node_[face_of(twin)];
                const Index c = chart_[face_of(twin)];
                if (other >= 0 && h < twin)
                    visit(node_[f], other, costs_.border[h]);
                else if (other < 0 && c == pair_.first)
                    visit(node_[f], core_a, costs_.border[h]);
                else if (other < 0 && c == pair_.second)
                    visit(node_[f], core_a + 1, costs_.border[h]);
            }
    }

    void evaluate(Parting& parting) const {
        visit_links([&](Index a, Index b, float cost) {
            if (parting.side[a] != parting.side[b])
                parting.length += cost;
        });
        for (std::size_t i = 0; i < faces_.size(); ++i) {
            const double area = costs_.gauss_area[faces_[i]];
            const bool was_a = chart_[faces_[i]] == pair_.first;
            const bool is_a = parting.side[i] == graph::CutSide::source;
            parting.moved += (was_a ? 1 : 0) * area - (is_a ? 1 : 0) * area;
        }
    }

    Parting solve(graph::MinCut& cut) const {
        Parting result;
        result.side = cut.solve();
        drop_islands(graph::CutSide::source, result.side);
        drop_islands(graph::CutSide::sink, result.side);
        evaluate(result);
        return result;
    }

    // Faces of the strip that hang together with their chart's core only through the other chart
    // go to that one. A price on Gauss area makes islands of single curved faces.
    void drop_islands(graph::CutSide which, std::vector<graph::CutSide>& side) const {
        const bool is_a = which == graph::CutSide::source;
        const Index own = is_a ? pair_.first : pair_.second;
        std::vector<std::uint8_t> held(faces_.size(), 0);
        std::vector<Index> stack;
        const auto hold = [&](std::size_t i) {
            if (held[i] == 0 && side[i] == which) {
                held[i] = 1;
                stack.push_back(faces_[i]);
            }
        };
        const auto for_neighbours = [&](Face f, auto visit) {
            for (const HalfEdge h : half_edges_of(f))
                if (mesh_.twin[h] >= 0)
                    visit(face_of(mesh_.twin[h]));
        };
        for (std::size_t i = 0; i < faces_.size(); ++i)
            for_neighbours(faces_[i], [&](Face g) {
                if (node_[g] < 0 && chart_[g] == own)
                    hold(i);
            });
        while (!stack.empty()) {
            const Face f = stack.back();
            stack.pop_back();
            for_neighbours(f, [&](Face g) {
                if (node_[g] >= 0)
                    hold(at(node_[g]));
            });
        }
        for (std::size_t i = 0; i < faces_.size(); ++i)
            if (held[i] == 0 && side[i] == which)
                side[i] = is_a ? graph::CutSide::sink : graph::CutSide::source;
    }

    const Mesh& mesh_;
    const BorderCosts& costs_;
    const std::vector<Index>& chart_;
    const Pair pair_;
    std::vector<Index>& node_; // #F: position in `faces`, −1 = none
    std::vector<Index> faces_;
};

class BorderBalancer {
public:
    BorderBalancer(const Mesh& mesh, const metrics::GaussAreas& areas, const mesh::Facets& facets,
                   const BorderBalance& options, Index count, std::vector<Index>& chart)
        : mesh_(mesh), areas_(areas), options_(options), chart_(chart), count_(count),
          costs_(measure_costs(mesh, areas, facets, options, count)),
          crease_(metrics::long_creases(mesh, areas.crease, count)), border_distance_(mesh),
          node_(mesh.faces.size(), -1), relabelling_(mesh, chart), changes_(at(count), 0) {}

    void sweep(Progress& progress) {
        fix_creases();
        deepest_ = border_distance_.farthest_faces(
            chart_, std::vector<Index>(at(count_), -1), [&](HalfEdge h) { return costs_.step[h]; },
            progress);
        gauss_area_ = metrics::chart_gauss_areas(mesh_, areas_, chart_, count_);
        std::vector<std::pair<Pair, Index>> borders; // the charts on both sides, half-edge
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin >= 0 && chart_[face_of(h)] < chart_[face_of(twin)])
                borders.push_back({{chart_[face_of(h)], chart_[face_of(twin)]}, h});
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
        fixed_.assign(mesh_.faces.size(), 0);
        for (const HalfEdge h : mesh_.all_half_edges())
            if (crease_[h] != 0 && chart_[face_of(h)] != chart_[face_of(mesh_.twin[h])])
                fixed_[face_of(h)] = 1;
    }

    // A wide strip may take a chart apart where a narrow one does not.
    bool move_border(const Pair& pair, const std::vector<Index>& edges) {
        double& area_a = gauss_area_[pair.first];
        double& area_b = gauss_area_[pair.second];
        for (const double share : {1.0, 0.5, 0.25}) {
            const float reach = static_cast<float>(share * options_.reach);
            const float widest = static_cast<float>(share) * costs_.widest;
            // The deepest face of a chart stays.
            const auto may_move = [&](Face f, float distance) {
                const Index c = chart_[f];
                return fixed_[f] == 0 && f != deepest_.face[c] &&
                       !(distance > std::min(reach * deepest_.distance[c], widest));
            };
            const Strip strip(mesh_, costs_, chart_, pair, edges, may_move, node_);
            const Parting now = strip.as_it_is();
            const Parting best = strip.best_parting(area_a, area_b, last_price_[pair]);
            if (!(strip.energy(area_a, area_b, best) <
                  strip.energy(area_a, area_b, now) * growth::truly_lower))
                return false;
            // A border may make a chart simpler, but not take it apart.
            const Face a = deepest_.face[pair.first];
            const Face b = deepest_.face[pair.second];
            if (!relabelling_.take({{{pair.first, a, a}, {pair.second, b, b}}}, strip.labels(best),
                                   {1.0, true}))
                continue;
            area_a -= best.moved;
            area_b += best.moved;
            return true;
        }
        return false;
    }

    const Mesh& mesh_;
    const metrics::GaussAreas& areas_;
    const BorderBalance& options_;
    std::vector<Index>& chart_;
    Index count_;
    const BorderCosts costs_;
    std::vector<std::uint8_t> crease_; // 3 #F: long creases
    std::vector<std::uint8_t> fixed_;  // #F: keeps its chart in this sweep
    std::vector<double> gauss_area_;   // of each chart
    growth::BorderDistance border_distance_;
    growth::FarthestFaces deepest_; // of each chart: stays where it is
    std::vector<Index> node_;       // #F: scratch of strips
    growth::Relabelling relabelling_;
    std::vector<int> changes_;    // of each chart: borders moved so far
    std::map<Pair, int> settled_; // changes of both charts when nothing could be gained
    std::map<Pair, double> last_price_;
};

} // namespace

void balance_borders(const Mesh& mesh, const metrics::GaussAreas& areas, const mesh::Facets& facets,
                     const BorderBalance& options, Index count, std::vector<Index>& chart,
                     Progress& progress) {
    BorderBalancer balancer(mesh, areas, facets, options, count, chart);
    for (int sweep = 0; sweep < options.sweeps; ++sweep) {
        progress.update(static_cast<double>(sweep) / options.sweeps);
        balancer.sweep(progress);
    }
}

} // namespace devseg::t_flooding
