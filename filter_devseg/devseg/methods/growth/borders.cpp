#include "devseg/methods/growth/borders.h"

#include <algorithm>
#include <utility>

#include "devseg/graph/min_cut.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/methods/growth/relabelling.h"

namespace devseg::growth {

namespace {

constexpr int smoothing_rounds = 4;
constexpr double crease_cosine = 0.7; // of 45 degrees: sharper edges are features, not noise

bool is_border(const Mesh& mesh, const std::vector<Index>& chart, HalfEdge h) {
    const HalfEdge twin = mesh.twin[h];
    return twin >= 0 && chart[h / 3] != chart[twin / 3];
}

// Vertices where borders end: three or more borders meet, or the mesh's boundary is reached.
std::vector<std::uint8_t> find_junctions(const Mesh& mesh, const std::vector<Index>& chart) {
    std::vector<std::uint8_t> borders(mesh.points.size(), 0);
    std::vector<std::uint8_t> on_boundary(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (is_border(mesh, chart, h) && borders[mesh.origin(h)] < 3)
            ++borders[mesh.origin(h)];
        if (mesh.twin[h] < 0)
            on_boundary[mesh.origin(h)] = on_boundary[mesh.target(h)] = 1;
    }
    std::vector<std::uint8_t> junction(mesh.points.size(), 0);
    for (std::size_t v = 0; v < junction.size(); ++v)
        junction[v] = borders[v] > 2 || (borders[v] > 0 && on_boundary[v] != 0) ? 1 : 0;
    return junction;
}

// The border half-edge of the same chart that goes on from the end of h.
Index next_on_border(const Mesh& mesh, const std::vector<Index>& chart, HalfEdge h) {
    h = Mesh::next(h);
    while (mesh.twin[h] >= 0 && !is_border(mesh, chart, h))
        h = Mesh::next(mesh.twin[h]);
    return h;
}

} // namespace

std::vector<BorderSegment> find_border_segments(const Mesh& mesh, const std::vector<Index>& chart) {
    const std::vector<std::uint8_t> junction = find_junctions(mesh, chart);
    std::vector<std::uint8_t> done(mesh.twin.size(), 0);
    std::vector<BorderSegment> segments;
    const auto walk = [&](Index start, bool is_loop) {
        BorderSegment segment;
        segment.chart_a = chart[start / 3];
        segment.chart_b = chart[mesh.twin[start] / 3];
        segment.is_loop = is_loop;
        for (HalfEdge h = start; done[h] == 0; h = next_on_border(mesh, chart, h)) {
            done[h] = done[mesh.twin[h]] = 1;
            segment.half_edges.push_back(h);
            if (junction[mesh.target(h)] != 0)
                break;
        }
        segments.push_back(std::move(segment));
    };
    const auto starts = [&](HalfEdge h) {
        return is_border(mesh, chart, h) && done[h] == 0 && chart[h / 3] < chart[mesh.twin[h] / 3];
    };
    for (const HalfEdge h : mesh.all_half_edges())
        if (starts(h) && junction[mesh.origin(h)] != 0)
            walk(h, false);
    for (const HalfEdge h : mesh.all_half_edges())
        if (starts(h))
            walk(h, true);
    return segments;
}

namespace {

// Normals averaged over neighbours, but not across creases: single faces of a scan lean far to one
// side, and would leave holes in the fuzzy area that the border has to wind around.
std::vector<Vec3> smooth_normals(const Mesh& mesh, const Progress& progress) {
    Heartbeat beat(progress);
    std::vector<Vec3> normals = mesh.face_normals;
    for (int round = 0; round < smoothing_rounds; ++round) {
        std::vector<Vec3> next(normals.size());
        for (const Face f : mesh.all_faces()) {
            beat();
            Vec3 sum = mesh.face_areas[f] * normals[f];
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh.twin[h];
                if (twin >= 0 &&
                    mesh.face_normals[f].dot(mesh.face_normals[twin / 3]) > crease_cosine)
                    sum += mesh.face_areas[twin / 3] * normals[twin / 3];
            }
            next[f] = sum.squaredNorm() > 0.0 ? Vec3(sum.normalized()) : normals[f];
        }
        normals = std::move(next);
    }
    return normals;
}

// Straightens one border after the other. The scratch arrays are for the whole mesh and are put
// back after each border, so that the cost follows the borders and not the mesh.
class Straightener {
public:
    Straightener(const Mesh& mesh, const ChartProxies& proxies, double max_fitting_error, int rings,
                 std::vector<Index>& chart, const Progress& progress)
        : mesh_(mesh), normals_(smooth_normals(mesh, progress)), proxies_(proxies),
          max_fitting_error_(max_fitting_error), rings_(rings), chart_(chart),
          fuzzy_(mesh.faces.size(), 0), blocked_(mesh.points.size(), 0), paths_(mesh.points.size()),
          new_border_(mesh.twin.size(), 0), leaving_(mesh::leaving_half_edges(mesh)),
          relabelling_(mesh, chart) {}

    bool straighten(const BorderSegment& segment) {
        grow_fuzzy_area(segment);
        const bool replaced = segment.is_loop ? straighten_loop(segment) : straighten_path(segment);
        for (const Face f : area_)
            fuzzy_[f] = 0;
        area_.clear();
        return replaced;
    }

private:
    // Both charts grown into each other [JKS05, section 3.3], from the faces at this border.
    void grow_fuzzy_area(const BorderSegment& segment) {
        std::vector<Index> left;
        std::vector<Index> right;
        for (const HalfEdge h : segment.half_edges) {
            left.push_back(h / 3);
            right.push_back(mesh_.twin[h] / 3);
        }
        grow_from(std::move(left), segment.chart_a, segment.chart_b);
        grow_from(std::move(right), segment.chart_b, segment.chart_a);
    }
    // Breadth first, so that the number of rings can be limited.
    void grow_from(std::vector<Index> ring, Index own, Index into) {
        const auto take = [&](Face f) {
            if (chart_[f] != own || fuzzy_[f] != 0 || !fits(f, into))
                return false;
            fuzzy_[f] = 1;
            area_.push_back(f);
            return true;
        };
        ring.erase(std::remove_if(ring.begin(), ring.end(), [&](Face f) { return !take(f); }),
                   ring.end());
        for (int depth = 1; !ring.empty() && (rings_ == 0 || depth < rings_); ++depth) {
            std::vector<Index> next;
            for (const Face f : ring)
                for (const HalfEdge h : half_edges_of(f)) {
                    const HalfEdge twin = mesh_.twin[h];
                    if (twin >= 0 && take(twin / 3))
                        next.push_back(twin / 3);
                }
            ring = std::move(next);
        }
    }
    bool fits(Face f, Index c) const {
        for (const metrics::ConicProxy& proxy : proxies_[c])
            if (proxy.fitting_error(normals_[f]) < max_fitting_error_)
                return true;
        return false;
    }

    // A vertex that a new border may pass: no other chart, no boundary and no other border of the
    // two charts comes there.
    bool is_free(Vertex v, const BorderSegment& segment) const {
        bool allowed = true;
        const bool whole = mesh::visit_star(mesh_, leaving_[v], [&](HalfEdge h) {
            const Index c = chart_[h / 3];
            allowed = allowed && (c == segment.chart_a || c == segment.chart_b);
            if (is_border(mesh_, chart_, h) && blocked_[v] == 0)
                allowed = false; // a border, but not of this segment
        });
        return whole && allowed;
    }

    bool straighten_path(const BorderSegment& segment) {
        const Index from = mesh_.origin(segment.half_edges.front());
        const Index to = mesh_.target(segment.half_edges.back());
        if (from == to || segment.half_edges.size() < 2)
            return false;
        for (const HalfEdge h : segment.half_edges)
            blocked_[mesh_.origin(h)] = blocked_[mesh_.target(h)] = 1; // own border: free
        mark(segment.half_edges, passable);
        const std::vector<Index> path = shortest_path(segment, from, to);
        mark(segment.half_edges, 0);
        for (const HalfEdge h : segment.half_edges)
            blocked_[mesh_.origin(h)] = blocked_[mesh_.target(h)] = 0;
        return !path.empty() && length(path) < length(segment.half_edges) * worthwhile &&
               relabel(segment, path);
    }

    void mark(const std::vector<Index>& half_edges, std::uint8_t value) {
        for (const HalfEdge h : half_edges)
            new_border_[h] = new_border_[mesh_.twin[h]] = value;
    }

    double length(const std::vector<Index>& half_edges) const {
        double sum = 0.0;
        for (const HalfEdge h : half_edges)
            sum += mesh_.edge_length(h);
        return sum;
    }

    // Over the old border and the edges that touch the fuzzy area; half-edges from `from` to `to`,
    // head to tail.
    std::vector<Index> shortest_path(const BorderSegment& segment, Index from, Index to) {
        paths_.add_source(from);
        paths_.run([&](Vertex v, double distance) {
            mesh::visit_star(mesh_, leaving_[v], [&](HalfEdge h) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0 || (fuzzy_[face_of(h)] == 0 && fuzzy_[face_of(twin)] == 0 &&
                                 new_border_[h] != passable))
                    return;
                const Vertex w = mesh_.target(h);
                const double through = distance + mesh_.edge_length(h);
                if (through < paths_.distance[w] && (w == to || is_free(w, segment)))
                    paths_.reach(w, through, h);
            });
            return v != to;
        });
        std::vector<Index> path;
        for (Vertex v = to; v != from && paths_.step[v] >= 0; v = mesh_.origin(path.back()))
            path.push_back(paths_.step[v]);
        std::reverse(path.begin(), path.end());
        paths_.clear();
        return path;
    }

    // Gives the parts of the fuzzy area beside the path to the chart on their side.
    bool relabel(const BorderSegment& segment, const std::vector<Index>& path) {
        mark(segment.half_edges, passable);
        mark(path, closed);
        NewLabels labels;
        bool consistent = true;
        const auto flood = [&](Index start, Index c) {
            std::vector<Index> stack;
            const auto take = [&](Face f) {
                if (fuzzy_[f] == 1) {
                    fuzzy_[f] = c == segment.chart_a ? 2 : 3;
                    labels.emplace_back(f, c);
                    stack.push_back(f);
                } else if (fuzzy_[f] == (c == segment.chart_a ? 3 : 2)) {
                    consistent = false;
                } else if (fuzzy_[f] == 0 && chart_[f] != c) {
                    consistent = false; // the area between the borders must be fuzzy
                }
            };
            take(start);
            while (!stack.empty() && consistent) {
                const Face f = stack.back();
                stack.pop_back();
                for (const HalfEdge h : half_edges_of(f)) {
                    const HalfEdge twin = mesh_.twin[h];
                    if (twin < 0 || new_border_[h] == closed)
                        continue;
                    if (is_border(mesh_, chart_, h) && new_border_[h] != passable)
                        continue;
                    take(twin / 3);
                }
            }
        };
        for (const HalfEdge h : path) {
            flood(h / 3, segment.chart_a);
            flood(mesh_.twin[h] / 3, segment.chart_b);
        }
        mark(segment.half_edges, 0);
        mark(path, 0);
        return consistent && apply(segment, labels);
    }

    // A loop that two charts share: the least cut between their cores.
    bool straighten_loop(const BorderSegment& segment) {
        if (area_.empty())
            return false;
        std::vector<std::pair<Index, Index>> index_of; // (face, node), sorted
        for (std::size_t i = 0; i < area_.size(); ++i)
            index_of.emplace_back(area_[i], static_cast<Index>(i));
        std::sort(index_of.begin(), index_of.end());
        const auto node_of = [&](Face f) {
            return std::lower_bound(index_of.begin(), index_of.end(), std::pair<Index, Index>(f, 0))
                ->second;
        };
        // Two more nodes stand for all that lies outside of the area.
        std::vector<graph::CutSide> sides(area_.size() + 2, graph::CutSide::open);
        const Index core_a = static_cast<Index>(area_.size());
        sides[core_a] = graph::CutSide::source;
        sides[core_a + 1] = graph::CutSide::sink;
        graph::MinCut cut(std::move(sides));
        bool has_core[2] = {false, false};
        for (const Face f : area_)
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0)
                    continue;
                const Index c = chart_[twin / 3];
                if (fuzzy_[twin / 3] != 0) {
                    if (twin > h)
                        cut.link(node_of(f), node_of(twin / 3), mesh_.edge_length(h));
                } else if (c == segment.chart_a || c == segment.chart_b) {
                    const int side = c == segment.chart_a ? 0 : 1;
                    has_core[side] = true;
                    cut.link(node_of(f), core_a + side, mesh_.edge_length(h));
                }
            }
        if (!has_core[0] || !has_core[1])
            return false;
        const std::vector<graph::CutSide> result = cut.solve();
        NewLabels labels;
        for (std::size_t i = 0; i < area_.size(); ++i)
            labels.emplace_back(area_[i], result[i] == graph::CutSide::source ? segment.chart_a
                                                                              : segment.chart_b);
        return apply(segment, labels);
    }

    // A border may not take a chart apart or change its topology.
    bool apply(const BorderSegment& segment, const NewLabels& labels) {
        const auto side = [&](Index c, HalfEdge h) -> Relabelling::Side {
            const auto found = std::find_if(labels.begin(), labels.end(),
                                            [&](const auto& label) { return label.second == c; });
            return {c, face_of(h), found == labels.end() ? Face() : Face(found->first)};
        };
        const HalfEdge first = segment.half_edges.front();
        return relabelling_.take(
            {side(segment.chart_a, first), side(segment.chart_b, mesh_.twin[first])}, labels,
            {largest_loss, false});
    }

    static constexpr double worthwhile = 1.0 - 1e-9; // shorter than rounding would explain
    static constexpr double largest_loss = 0.3;      // of a chart's faces: it must stay what it is
    static constexpr std::uint8_t passable = 1;
    static constexpr std::uint8_t closed = 2;

    const Mesh& mesh_;
    std::vector<Vec3> normals_; // #F
    const ChartProxies& proxies_;
    double max_fitting_error_;
    int rings_;
    std::vector<Index>& chart_;
    std::vector<std::uint8_t> fuzzy_;      // #F: 1 = in the area; 2, 3 = given to chart a, b
    std::vector<Index> area_;              // the faces in the fuzzy area
    std::vector<std::uint8_t> blocked_;    // #V: 1 on the border at hand
    graph::ShortestPaths<> paths_;         // #V: their steps are half-edges
    std::vector<std::uint8_t> new_border_; // 3 #F
    std::vector<Index> leaving_;           // #V: a half-edge that leaves the vertex
    Relabelling relabelling_;
};

} // namespace

Index straighten_borders(const Mesh& mesh, const ChartProxies& proxies, double max_fitting_error,
                         int rings, std::vector<Index>& chart, Progress& progress) {
    Straightener straightener(mesh, proxies, max_fitting_error, rings, chart, progress);
    Index replaced = 0;
    progress.check();
    std::vector<BorderSegment> segments = find_border_segments(mesh, chart);
    // Each border changes what the next ones find: the longest first, whatever the order of faces.
    const auto length = [&](const BorderSegment& segment) {
        double sum = 0.0;
        for (const HalfEdge h : segment.half_edges)
            sum += mesh.edge_length(h);
        return sum;
    };
    std::stable_sort(
        segments.begin(), segments.end(),
        [&](const BorderSegment& a, const BorderSegment& b) { return length(a) > length(b); });
    for (std::size_t i = 0; i < segments.size(); ++i) {
        progress.update(static_cast<double>(i) / static_cast<double>(segments.size()));
        replaced += straightener.straighten(segments[i]) ? 1 : 0;
    }
    return replaced;
}

} // namespace devseg::growth
