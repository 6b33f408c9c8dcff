#include "devseg/methods/growth/borders.h"

#include <algorithm>
#include <utility>

#include "devseg/graph/min_cut.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/methods/growth/relabelling.h"

namespace devseg::growth {

namespace {

struct BorderTuning {
    int normal_rounds = 4;      // of smoothing
    double crease_cosine = 0.7; // of 45 degrees: sharper edges are features, not noise
    double largest_loss = 0.3;  // of a chart's faces: it must stay what it is
};
constexpr BorderTuning tuning;

bool is_border(const Mesh& mesh, const std::vector<Index>& chart, HalfEdge h) {
    const HalfEdge twin = mesh.twin[h];
    return twin >= 0 && chart[face_of(h)] != chart[face_of(twin)];
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
    const auto walk = [&](HalfEdge start, bool is_loop) {
        BorderSegment segment;
        segment.chart_a = chart[face_of(start)];
        segment.chart_b = chart[face_of(mesh.twin[start])];
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
        return is_border(mesh, chart, h) && done[h] == 0 &&
               chart[face_of(h)] < chart[face_of(mesh.twin[h])];
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
    for (int round = 0; round < tuning.normal_rounds; ++round) {
        std::vector<Vec3> next(normals.size());
        for (const Face f : mesh.all_faces()) {
            beat();
            Vec3 sum = mesh.face_areas[f] * normals[f];
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh.twin[h];
                if (twin >= 0 && mesh.face_normals[f].dot(mesh.face_normals[face_of(twin)]) >
                                     tuning.crease_cosine)
                    sum += mesh.face_areas[face_of(twin)] * normals[face_of(twin)];
            }
            next[f] = sum.squaredNorm() > 0.0 ? Vec3(sum.normalized()) : normals[f];
        }
        normals = std::move(next);
    }
    return normals;
}

double length(const Mesh& mesh, const std::vector<Index>& half_edges) {
    double sum = 0.0;
    for (const HalfEdge h : half_edges)
        sum += mesh.edge_length(h);
    return sum;
}

// Where the border at hand may run: both charts grown into each other [JKS05, section 3.3].
class FuzzyArea {
public:
    enum Side : std::uint8_t { outside, open, given_to_a, given_to_b };

    std::vector<std::uint8_t> side; // #F
    std::vector<Index> faces;       // all but those outside

    FuzzyArea(const Mesh& mesh, const ChartProxies& proxies, double max_fitting_error, int rings,
              const Progress& progress)
        : side(mesh.faces.size(), outside), mesh_(mesh), normals_(smooth_normals(mesh, progress)),
          proxies_(proxies), max_fitting_error_(max_fitting_error), rings_(rings) {}

    void grow(const BorderSegment& segment, const std::vector<Index>& chart) {
        std::vector<Index> left;
        std::vector<Index> right;
        for (const HalfEdge h : segment.half_edges) {
            left.push_back(face_of(h));
            right.push_back(face_of(mesh_.twin[h]));
        }
        grow_from(std::move(left), segment.chart_a, segment.chart_b, chart);
        grow_from(std::move(right), segment.chart_b, segment.chart_a, chart);
    }

    void clear() {
        for (const Face f : faces)
            side[f] = outside;
        faces.clear();
    }

private:
    // Breadth first, so that the number of rings can be limited.
    void grow_from(std::vector<Index> ring, Index own, Index into,
                   const std::vector<Index>& chart) {
        const auto take = [&](Face f) {
            if (chart[f] != own || side[f] != outside || !fits(f, into))
                return false;
            side[f] = open;
            faces.push_back(f);
            return true;
        };
        ring.erase(std::remove_if(ring.begin(), ring.end(), [&](Face f) { return !take(f); }),
                   ring.end());
        for (int depth = 1; !ring.empty() && (rings_ == 0 || depth < rings_); ++depth) {
            std::vector<Index> next;
            for (const Face f : ring)
                for (const HalfEdge h : half_edges_of(f)) {
                    const HalfEdge twin = mesh_.twin[h];
                    if (twin >= 0 && take(face_of(twin)))
                        next.push_back(face_of(twin));
                }
            ring = std::move(next);
        }
    }
    bool fits(Face f, Index c) const {
        return std::any_of(proxies_[c].begin(), proxies_[c].end(), [&](const auto& proxy) {
            return proxy.fitting_error(normals_[f]) < max_fitting_error_;
        });
    }

    const Mesh& mesh_;
    std::vector<Vec3> normals_; // #F
    const ChartProxies& proxies_;
    double max_fitting_error_;
    int rings_;
};

// Straightens one border after the other. The scratch arrays are for the whole mesh and are put
// back after each border, so that the cost follows the borders and not the mesh.
class BorderStraightener {
public:
    BorderStraightener(const Mesh& mesh, FuzzyArea area, std::vector<Index>& chart)
        : mesh_(mesh), area_(std::move(area)), chart_(chart), own_border_(mesh.points.size(), 0),
          paths_(mesh.points.size()), border_(mesh.twin.size(), 0),
          leaving_(mesh::leaving_half_edges(mesh)), relabelling_(mesh, chart) {}

    bool straighten(const BorderSegment& segment) {
        area_.grow(segment, chart_);
        const bool replaced = segment.is_loop ? straighten_loop(segment) : straighten_path(segment);
        area_.clear();
        return replaced;
    }

private:
    enum : std::uint8_t { passable = 1, closed }; // kinds of borders

    // A vertex that a new border may pass: no other chart, no boundary and no other border of the
    // two charts comes there.
    bool is_free(Vertex v, const BorderSegment& segment) const {
        bool allowed = true;
        const bool whole = mesh::visit_star(mesh_, leaving_[v], [&](HalfEdge h) {
            const Index c = chart_[face_of(h)];
            allowed = allowed && (c == segment.chart_a || c == segment.chart_b);
            if (is_border(mesh_, chart_, h) && own_border_[v] == 0)
                allowed = false; // a border, but not of this segment
        });
        return whole && allowed;
    }

    bool straighten_path(const BorderSegment& segment) {
        const Index from = mesh_.origin(segment.half_edges.front());
        const Index to = mesh_.target(segment.half_edges.back());
        if (from == to || segment.half_edges.size() < 2)
            return false;
        const auto set_own = [&](std::uint8_t own) {
            for (const HalfEdge h : segment.half_edges)
                own_border_[mesh_.origin(h)] = own_border_[mesh_.target(h)] = own;
            mark(segment.half_edges, own != 0 ? passable : 0);
        };
        set_own(1);
        const std::vector<Index> path = shortest_path(segment, from, to);
        set_own(0);
        return !path.empty() &&
               length(mesh_, path) < length(mesh_, segment.half_edges) * truly_lower &&
               relabel(segment, path);
    }

    void mark(const std::vector<Index>& half_edges, std::uint8_t value) {
        for (const HalfEdge h : half_edges)
            border_[h] = border_[mesh_.twin[h]] = value;
    }

    // Over the old border and the edges that touch the fuzzy area; half-edges from `from` to `to`,
    // head to tail.
    std::vector<Index> shortest_path(const BorderSegment& segment, Index from, Index to) {
        paths_.add_source(from);
        paths_.run([&](Vertex v, double distance) {
            mesh::visit_star(mesh_, leaving_[v], [&](HalfEdge h) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0 ||
                    (area_.side[face_of(h)] == FuzzyArea::outside &&
                     area_.side[face_of(twin)] == FuzzyArea::outside && border_[h] != passable))
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
        for (const HalfEdge h : path) {
            consistent =
                consistent && flood(face_of(h), segment.chart_a, FuzzyArea::given_to_a, labels) &&
                flood(face_of(mesh_.twin[h]), segment.chart_b, FuzzyArea::given_to_b, labels);
        }
        mark(segment.half_edges, 0);
        mark(path, 0);
        return consistent && apply(segment, labels);
    }

    // Gives the faces on one side of the marked borders to chart c. False where the other chart has
    // taken them, or where they may not change: the area between the borders must be fuzzy.
    bool flood(Face start, Index c, FuzzyArea::Side side, NewLabels& labels) {
        std::vector<Index> stack;
        const auto take = [&](Face f) {
            if (area_.side[f] == FuzzyArea::outside || area_.side[f] == side)
                return area_.side[f] == side || chart_[f] == c;
            if (area_.side[f] != FuzzyArea::open)
                return false;
            area_.side[f] = side;
            labels.emplace_back(f, c);
            stack.push_back(f);
            return true;
        };
        bool consistent = take(start);
        while (!stack.empty() && consistent) {
            const Face f = stack.back();
            stack.pop_back();
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                const bool is_open = twin >= 0 && border_[h] != closed &&
                                     (border_[h] == passable || !is_border(mesh_, chart_, h));
                consistent = consistent && (!is_open || take(face_of(twin)));
            }
        }
        return consistent;
    }

    // A loop that two charts share: the least cut between their cores.
    bool straighten_loop(const BorderSegment& segment) {
        if (area_.faces.empty())
            return false;
        const Index core_a = static_cast<Index>(area_.faces.size());
        std::vector<std::pair<Index, Index>> nodes; // (face, node), sorted
        for (Index i = 0; i < core_a; ++i)
            nodes.emplace_back(area_.faces[i], i);
        std::sort(nodes.begin(), nodes.end());
        const auto node_of = [&](Face f) {
            return std::lower_bound(nodes.begin(), nodes.end(), std::pair<Index, Index>(f, 0))
                ->second;
        };
        // Two more nodes stand for all that lies outside of the area.
        std::vector<graph::CutSide> sides(area_.faces.size() + 2, graph::CutSide::open);
        sides[core_a] = graph::CutSide::source;
        sides[core_a + 1] = graph::CutSide::sink;
        graph::MinCut cut(std::move(sides));
        bool has_core[2] = {false, false};
        for (const Face f : area_.faces)
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0)
                    continue;
                const Face g = face_of(twin);
                if (area_.side[g] != FuzzyArea::outside) {
                    if (twin > h)
                        cut.link(node_of(f), node_of(g), mesh_.edge_length(h));
                } else if (chart_[g] == segment.chart_a || chart_[g] == segment.chart_b) {
                    const int side = chart_[g] == segment.chart_a ? 0 : 1;
                    has_core[side] = true;
                    cut.link(node_of(f), core_a + side, mesh_.edge_length(h));
                }
            }
        if (!has_core[0] || !has_core[1])
            return false;
        const std::vector<graph::CutSide> result = cut.solve();
        NewLabels labels;
        for (Index i = 0; i < core_a; ++i)
            labels.emplace_back(area_.faces[i], result[i] == graph::CutSide::source
                                                    ? segment.chart_a
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
            {tuning.largest_loss, false});
    }

    const Mesh& mesh_;
    FuzzyArea area_;
    std::vector<Index>& chart_;
    std::vector<std::uint8_t> own_border_; // #V: 1 on the border at hand
    graph::ShortestPaths<> paths_;         // #V: their steps are half-edges
    std::vector<std::uint8_t> border_;     // 3 #F: passable, closed or 0
    std::vector<Index> leaving_;           // #V: a half-edge that leaves the vertex
    Relabelling relabelling_;
};

} // namespace

Index straighten_borders(const Mesh& mesh, const ChartProxies& proxies, double max_fitting_error,
                         int rings, std::vector<Index>& chart, Progress& progress) {
    BorderStraightener straightener(
        mesh, FuzzyArea(mesh, proxies, max_fitting_error, rings, progress), chart);
    Index replaced = 0;
    progress.check();
    std::vector<BorderSegment> segments = find_border_segments(mesh, chart);
    // Each border changes what the next ones find: the longest first, whatever the order of faces.
    std::stable_sort(segments.begin(), segments.end(),
                     [&](const BorderSegment& a, const BorderSegment& b) {
                         return length(mesh, a.half_edges) > length(mesh, b.half_edges);
                     });
    for (std::size_t i = 0; i < segments.size(); ++i) {
        progress.update(static_cast<double>(i) / static_cast<double>(segments.size()));
        replaced += straightener.straighten(segments[i]) ? 1 : 0;
    }
    return replaced;
}

} // namespace devseg::growth
