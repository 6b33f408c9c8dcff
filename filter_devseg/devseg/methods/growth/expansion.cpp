#include "devseg/methods/growth/borders.h"

#include <algorithm>
#include <cmath>

#include "devseg/atlas/border_path.h"
#include "devseg/graph/min_cut.h"

namespace devseg::growth {

namespace {

struct ExpansionTuning {
    // Above F_max a face pays this many times the excess, so that only faces that fit nowhere, and
    // faces enclosed by others, are given to a chart that they do not fit.
    double excess_weight = 20.0;
    // A chart is offered faces up to this multiple of F_max; beyond it they cannot be worth it.
    double offered = 1.5;
    double settled_share = 2e-3; // of the faces: fewer changes in a round end it
};
constexpr ExpansionTuning tuning;

class Expansion {
public:
    Expansion(const Mesh& mesh, const std::vector<metrics::ConicProxy>& proxies,
              const ExpansionOptions& options, std::vector<Index>& chart)
        : mesh_(mesh), proxies_(proxies), options_(options), chart_(chart),
          node_(mesh.faces.size(), -1), weight_(mesh.twin.size(), 0.0) {
        const double scale = options.length_weight * std::sqrt(mesh.total_area);
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] >= 0)
                weight_[h] = scale * atlas::crease_factor(mesh, h) * mesh.edge_length(h);
    }

    // Lets one chart take what lowers the sum; returns the number of faces that it took.
    Index expand(Index label) {
        find_candidates(label);
        if (faces_.empty())
            return 0;
        const Index taken = solve(label);
        for (const Face f : faces_)
            node_[f] = -1;
        faces_.clear();
        return taken;
    }

private:
    double cost(Face f, Index label) const {
        const double error = proxies_[label].fitting_error(mesh_.face_normals[f]);
        const double beyond = std::max(0.0, error - options_.max_fitting_error);
        return mesh_.face_areas[f] * (error + tuning.excess_weight * beyond);
    }

    // Faces of other charts that the chart reaches over faces which it may take.
    void find_candidates(Index label) {
        const auto offer = [&](Face f) {
            for (const HalfEdge h : half_edges_of(f)) {
                if (mesh_.twin[h] < 0)
                    continue;
                const Face g = face_of(mesh_.twin[h]);
                if (chart_[g] == label || node_[g] >= 0 ||
                    proxies_[label].fitting_error(mesh_.face_normals[g]) >=
                        tuning.offered * options_.max_fitting_error)
                    continue;
                node_[g] = static_cast<Index>(faces_.size());
                faces_.push_back(g);
            }
        };
        for (const Face f : mesh_.all_faces())
            if (chart_[f] == label)
                offer(f);
        for (std::size_t i = 0; i < faces_.size(); ++i)
            offer(faces_[i]);
    }

    // Nodes on the source's side take the label, the others keep theirs.
    Index solve(Index label) {
        const Index count = static_cast<Index>(faces_.size());
        const Index source = count;
        const Index sink = count + 1;
        std::vector<graph::CutSide> sides(faces_.size() + 2, graph::CutSide::open);
        sides[source] = graph::CutSide::source;
        sides[sink] = graph::CutSide::sink;
        std::vector<double> take(faces_.size());
        std::vector<double> keep(faces_.size());
        links_.clear();
        for (Index i = 0; i < count; ++i) {
            const Face f = faces_[i];
            const Index own = chart_[f];
            take[i] += cost(f, label);
            keep[i] += cost(f, own);
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0)
                    continue;
                const Index other = chart_[face_of(twin)];
                const Index node = node_[face_of(twin)];
                const double w = weight_[h];
                if (node >= 0 && other == own) {
                    if (h < twin)
                        links_.push_back({i, node, w});
                } else if (node >= 0) {
                    if (h < twin)
                        link_across_border(i, node, source, w, sides);
                } else if (other == label) {
                    keep[i] += w;
                } else {
                    take[i] += w;
                    keep[i] += other == own ? 0.0 : w;
                }
            }
        }
        graph::MinCut cut(std::move(sides));
        for (Index i = 0; i < count; ++i) {
            const double difference = keep[i] - take[i];
            if (difference > 0.0)
                cut.link(source, i, difference);
            else
                cut.link(i, sink, -difference);
        }
        for (const Link& link : links_)
            cut.link(link.a, link.b, link.weight);
        const std::vector<graph::CutSide> side = cut.solve();
        Index taken = 0;
        for (Index i = 0; i < count; ++i)
            if (side[i] == graph::CutSide::source) {
                chart_[faces_[i]] = label;
                ++taken;
            }
        return taken;
    }

    // An edge on a border costs w unless both faces take the label: one more node [BVZ01, fig. 5].
    void link_across_border(Index a, Index b, Index source, double w,
                            std::vector<graph::CutSide>& sides) {
        const Index extra = static_cast<Index>(sides.size());
        sides.push_back(graph::CutSide::open);
        links_.push_back({extra, a, w});
        links_.push_back({extra, b, w});
        links_.push_back({extra, source, w});
    }

    struct Link {
        Index a, b;
        double weight;
    };

    const Mesh& mesh_;
    const std::vector<metrics::ConicProxy>& proxies_;
    const ExpansionOptions& options_;
    std::vector<Index>& chart_;
    std::vector<Index> faces_;   // candidates of the current move
    std::vector<Index> node_;    // #F: number among the candidates, −1 for others
    std::vector<double> weight_; // 3 #F: what the edge costs as a border
    std::vector<Link> links_;
};

} // namespace

void relabel_by_expansion(const Mesh& mesh, std::vector<metrics::ConicProxy> proxies,
                          const ExpansionOptions& options, std::vector<Index>& chart,
                          Progress& progress) {
    Expansion expansion(mesh, proxies, options, chart);
    const std::size_t count = proxies.size();
    for (int round = 0; round < options.max_rounds; ++round) {
        Index changed = 0;
        for (std::size_t c = 0; c < count; ++c) {
            progress.update((static_cast<double>(c) / static_cast<double>(count) + round) /
                            options.max_rounds);
            changed += expansion.expand(static_cast<Index>(c));
        }
        if (changed < tuning.settled_share * static_cast<double>(mesh.faces.size()))
            return;
        proxies = metrics::fit_conics(mesh, chart, static_cast<Index>(count));
    }
}

} // namespace devseg::growth
