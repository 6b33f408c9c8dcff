#include "devseg/methods/plush/transfer_seams.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "devseg/mesh/surface_search.h"
#include "devseg/methods/plush/seam_guides.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// The vertices that pull at each vertex of a seam; none at those that stay.
std::vector<std::vector<Index>> find_threads(const Mesh& mesh, const SeamMarks& seam) {
    const std::vector<Index> degree = seam_degrees(mesh, seam);
    const std::vector<std::uint8_t> on_border = mesh::boundary_vertices(mesh);
    std::vector<std::vector<Index>> threads(mesh.points.size());
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Vertex v = mesh.origin(h);
        if (seam[h] == 0 || degree[v] < 2 || on_border[v] != 0)
            continue;
        threads[v].push_back(mesh.target(h));
    }
    return threads;
}

double distance_to_line(const Vec3& p, const std::vector<Vec3>& line) {
    double least = infinite;
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
        least = std::min(least, squared_distance(p, line[i], line[i + 1]));
    return std::sqrt(least);
}

class SeamTransfer {
public:
    SeamTransfer(const Mesh& from, const Mesh& to, const VertexGraph& graph,
                 const std::vector<double>& factor, TransferRest rest)
        : from_(from), to_(to), graph_(graph), factor_(factor), rest_(std::move(rest)), search_(to),
          normal_(mesh::vertex_normals(from)), on_border_(mesh::boundary_vertices(from)),
          may_border_(mesh::boundary_vertices(to)),
          reach_(tuning.strip_width * mean_edge_length(from)),
          leaning_(tuning.leaning * mean_edge_length(to) *
                   std::clamp(2.0 * (mean_edge_length(from) / mean_edge_length(to) - 1.0),
                              tuning.least_leaning, 1.0)),
          seam_(rest_.seam), taken_(to.points.size(), 0), place_(rest_.place) {
        seam_.resize(to.twin.size(), 0);
        place_.resize(from.points.size(), -1);
        for (const HalfEdge h : to.all_half_edges())
            if (seam_[h] != 0)
                taken_[to.origin(h)] = taken_[to.target(h)] = 1;
        for (const HalfEdge h : to.all_half_edges())
            cost_.push_back(cost_of(h, reach_));
    }

    SeamMarks run(const SeamMarks& seam, Progress& progress) {
        points_ = rest_.is_smooth ? from_.points : smooth_seams(from_, seam);
        std::vector<SeamSegment> segments = find_segments(from_, seam);
        std::stable_sort(
            segments.begin(), segments.end(),
            [](const SeamSegment& a, const SeamSegment& b) { return a.length > b.length; });
        std::vector<Line> lines;
        for (const SeamSegment& segment : segments)
            add_lines(segment, lines);
        for (const Line& line : lines)
            for (const Vertex v : {line.front(), line.back()})
                if (place(v) >= 0)
                    taken_[place(v)] = 1;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            progress.update(static_cast<double>(i) / static_cast<double>(lines.size()));
            transfer(lines[i], progress);
        }
        return std::move(seam_);
    }

private:
    using Line = std::vector<Index>; // vertices of a part of a segment

    static bool is_set(const std::vector<std::uint8_t>& marks, Index i) {
        return !marks.empty() && marks[at(i)] != 0;
    }

    // Of a segment, in short parts.
    void add_lines(const SeamSegment& segment, std::vector<Line>& lines) const {
        const std::size_t count = segment.half_edges.size();
        const std::size_t least = segment.is_loop ? std::min<std::size_t>(3, count) : 1;
        const std::size_t parts = std::max(least, count / tuning.path_edges);
        for (std::size_t part = 0; part < parts; ++part) {
            Line line;
            for (std::size_t k = part * count / parts; k < (part + 1) * count / parts; ++k) {
                const HalfEdge h = segment.half_edges[k];
                if (is_set(rest_.edges, h)) {
                    if (!line.empty())
                        lines.push_back(std::exchange(line, {}));
                    continue;
                }
                if (line.empty())
                    line.push_back(from_.origin(h));
                line.push_back(from_.target(h));
            }
            if (!line.empty())
                lines.push_back(std::move(line));
        }
    }

    Index place(Vertex v) {
        if (place_[v] < 0)
            place_[v] = search_.vertex(points_[v], normal_[v], [&](Index u) {
                return (on_border_[v] == 0 || may_border_[u] != 0) && !is_set(rest_.closed, u);
            });
        return place_[v];
    }

    void transfer(const Line& line, const Progress& progress) {
        const Index start = place(line.front());
        const Index end = place(line.back());
        if (start < 0 || end < 0 || start == end)
            return;
        const std::vector<std::uint8_t> strip = lean_towards(line);
        std::vector<std::uint8_t> open(strip.size(), 1);
        for (std::size_t v = 0; v < open.size(); ++v)
            if (is_set(rest_.closed, static_cast<Index>(v)))
                open[v] = 0;
        std::vector<std::uint8_t> beside = strip;
        for (std::size_t v = 0; v < beside.size(); ++v)
            if (open[v] == 0)
                beside[v] = 0;
        std::vector<std::uint8_t> free = beside;
        for (std::size_t v = 0; v < free.size(); ++v)
            if (taken_[v] != 0)
                free[v] = 0;
        for (std::vector<std::uint8_t>* allowed : {&open, &beside, &free})
            (*allowed)[start] = (*allowed)[end] = 1;
        // Where other seams leave no room the path shares their edges.
        for (const std::vector<std::uint8_t>& allowed :
             {free, beside, open, std::vector<std::uint8_t>{}}) {
            const PathTree tree = shortest_paths(graph_, cost_, {start}, progress, allowed);
            if (!std::isfinite(tree.distance[end]))
                continue;
            for (const HalfEdge h : trace_path(to_, tree, end)) {
                mark(to_, h, 1, seam_);
                taken_[to_.origin(h)] = taken_[to_.target(h)] = 1;
            }
            return;
        }
    }

    double cost_of(HalfEdge h, double away) const {
        const double d = away / leaning_;
        return to_.edge_length(h) * (1.0 + d * d) * factor_[h];
    }

    // Sets the cost of the edges near the line; returns the vertices there.
    std::vector<std::uint8_t> lean_towards(const std::vector<Index>& line) {
        std::vector<Vec3> points;
        for (const Vertex v : line)
            points.push_back(points_[v]);
        std::vector<double> away(to_.points.size(), reach_);
        std::vector<std::uint8_t> strip(to_.points.size(), 0);
        std::vector<Index> queue;
        const auto visit = [&](Vertex v) {
            if (strip[v] != 0)
                return;
            const double distance = distance_to_line(to_.points[v], points);
            if (distance > reach_)
                return;
            strip[v] = 1;
            away[v] = distance;
            queue.push_back(v);
        };
        for (const Vertex v : line)
            if (const Index u = place(v); u >= 0) {
                visit(u);
            }
        for (std::size_t k = 0; k < queue.size(); ++k)
            for (Index i = graph_.begin[queue[k]]; i < graph_.begin[at(queue[k]) + 1]; ++i)
                visit(graph_.vertex[i]);
        for (const HalfEdge h : near_)
            cost_[h] = cost_of(h, reach_);
        near_.clear();
        for (const Vertex v : queue)
            for (Index i = graph_.begin[v]; i < graph_.begin[at(v) + 1]; ++i) {
                const HalfEdge h = graph_.half_edge[i];
                cost_[h] = cost_of(h, 0.5 * (away[to_.origin(h)] + away[to_.target(h)]));
                near_.push_back(h);
            }
        strip[place(line.front())] = strip[place(line.back())] = 1;
        return strip;
    }

    const Mesh& from_;
    const Mesh& to_;
    const VertexGraph& graph_;
    const std::vector<double>& factor_; // 3 #F of to
    const TransferRest rest_;
    const mesh::SurfaceSearch search_;
    std::vector<Vec3> points_;                   // #V of from: on smooth seams
    const std::vector<Vec3> normal_;             // #V of from
    const std::vector<std::uint8_t> on_border_;  // #V of from
    const std::vector<std::uint8_t> may_border_; // #V of to
    const double reach_;
    const double leaning_;
    SeamMarks seam_;
    std::vector<std::uint8_t> taken_; // #V of to: on a seam, or an end of one
    std::vector<Index> place_;        // #V of from: the vertex of to
    std::vector<double> cost_;        // 3 #F of to
    std::vector<Index> near_;         // half-edges of to that are near the line of the last turn
};

// Seams along two edges of a face take the third one; where they meet others, one of the two does.
// A face that hangs on one edge, or in an acute corner, keeps its area badly. Seams only become
// shorter.
void cut_corners(const Mesh& mesh, SeamMarks& seam) {
    std::vector<Index> degree = seam_degrees(mesh, seam);
    for (bool changed = true; changed;) {
        changed = false;
        for (const HalfEdge h : mesh.all_half_edges()) {
            const HalfEdge n = Mesh::next(h);
            const HalfEdge third = Mesh::previous(h);
            if (seam[h] == 0 || seam[n] == 0 || seam[third] != 0 || mesh.twin[third] < 0)
                continue;
            if (degree[mesh.target(h)] != 2) {
                const HalfEdge longer = mesh.edge_length(h) >= mesh.edge_length(n) ? h : n;
                const Vertex outer = longer == h ? mesh.origin(h) : mesh.target(n);
                if (degree[outer] != 2 || !(mesh.edge_length(third) < mesh.edge_length(longer)))
                    continue;
                mark(mesh, longer, 0, seam);
                --degree[mesh.target(h)];
                ++degree[longer == h ? mesh.target(n) : mesh.origin(h)];
            } else {
                mark(mesh, h, 0, seam);
                mark(mesh, n, 0, seam);
                degree[mesh.target(h)] = 0;
            }
            mark(mesh, third, 1, seam);
            changed = true;
        }
    }
}

// Means over each vertex and its neighbours, so many times.
void smooth_moves(const VertexGraph& graph, int rounds, std::vector<Vec3>& moves) {
    for (int round = 0; round < rounds; ++round) {
        std::vector<Vec3> next = moves;
        for (std::size_t v = 0; v < moves.size(); ++v) {
            for (Index i = graph.begin[v]; i < graph.begin[v + 1]; ++i)
                next[v] += moves[graph.vertex[i]];
            next[v] /= 1.0 + graph.begin[v + 1] - graph.begin[v];
        }
        moves = std::move(next);
    }
}

// An edge between two vertices, in either direction; −1 where there is none.
HalfEdge edge_between(const VertexGraph& graph, Vertex a, Vertex b) {
    for (Index i = graph.begin[a]; i < graph.begin[at(a) + 1]; ++i)
        if (graph.vertex[i] == b)
            return HalfEdge(graph.half_edge[i]);
    return HalfEdge(-1);
}

// Edges that were cut by the plane shrink to one of their ends. What a segment then runs along
// twice is a spur, and none of it.
SeamMarks own_half(const MirroredModel& mirrored, const SeamMarks& seam, const Mesh& model,
                   const VertexGraph& graph) {
    const Mesh& mesh = mirrored.surface.mesh;
    SeamMarks marks(model.twin.size(), 0);
    for (const SeamSegment& segment : find_segments(mesh, seam)) {
        std::set<Index> line;
        for (const HalfEdge h : segment.half_edges) {
            if (mirrored.surface.is_image(h))
                continue;
            const HalfEdge edge = edge_between(graph, Vertex(mirrored.place[mesh.origin(h)]),
                                               Vertex(mirrored.place[mesh.target(h)]));
            if (edge >= 0 && !line.insert(edge).second)
                line.erase(edge);
        }
        for (const Index h : line)
            mark(model, HalfEdge(h), 1, marks);
    }
    return marks;
}

} // namespace

std::vector<Vec3> smooth_seams(const Mesh& mesh, const SeamMarks& seam) {
    const std::vector<std::vector<Index>> threads = find_threads(mesh, seam);
    const mesh::SurfaceSearch search(mesh);
    std::vector<Vec3> points = mesh.points;
    for (int round = 1; round <= tuning.curve_rounds; ++round) {
        std::vector<Vec3> next = points;
        for (std::size_t v = 0; v < threads.size(); ++v) {
            if (threads[v].empty())
                continue;
            Vec3 sum = Vec3::Zero();
            for (const Index u : threads[v])
                sum += points[u];
            next[v] = 0.5 * points[v] + 0.5 / static_cast<double>(threads[v].size()) * sum;
            if (round < tuning.curve_rounds)
                continue;
            const Index near = search.vertex(next[v], search.normal(static_cast<Index>(v)),
                                             [](Index) { return true; });
            if (near >= 0)
                next[v] = search.on_faces(next[v], near, [](Index) { return true; }).second;
        }
        points = std::move(next);
    }
    return points;
}

SeamMarks transfer_seams(const Mesh& from, const SeamMarks& seam, const Mesh& to,
                         const VertexGraph& graph, const std::vector<double>& factor,
                         TransferRest rest, Progress& progress) {
    SeamMarks transferred =
        SeamTransfer(from, to, graph, factor, std::move(rest)).run(seam, progress);
    cut_corners(to, transferred);
    return transferred;
}

Mesh fitted_to(const Mesh& model, const Mesh& surface, const VertexGraph& graph,
               const Progress& progress) {
    const mesh::SurfaceSearch search(model);
    Mesh fitted = surface;
    std::vector<Vec3> moves(surface.points.size(), Vec3::Zero());
    const auto anywhere = [](Index) { return true; };
    for (int turn = 0; turn < tuning.fit_turns; ++turn) {
        const std::vector<Vec3> normal = mesh::vertex_normals(fitted);
        for (const Vertex v : surface.all_vertices()) {
            if (v % 1024 == 0)
                progress.check();
            const Vec3& p = fitted.points[v];
            // Along the model it is the neighbours' move: tips come off worst from
            // nearest points.
            if (const Vertex near = search.vertex(p, normal[v], anywhere); near >= 0) {
                const Vec3& across = search.normal(near);
                const Vec3 place = search.on_faces(p, near, anywhere).second;
                moves[v] += (place - p).dot(across) * across;
            }
        }
        // Whole limbs first, then what is smaller.
        smooth_moves(graph, tuning.fit_turns - turn, moves);
        for (const Vertex v : surface.all_vertices())
            fitted.points[v] = surface.points[v] + moves[v];
        mesh::compute_face_geometry(fitted);
    }
    return fitted;
}

SeamMarks seams_on_model(const MirroredModel& mirrored, const Mesh& placed, const SeamMarks& seam,
                         const Mesh& model, const VertexGraph& graph, Progress& progress) {
    TransferRest rest;
    for (const HalfEdge h : placed.all_half_edges())
        rest.edges.push_back(mirrored.surface.is_image(h) ? 0 : 1);
    rest.closed.assign(model.points.size(), 0);
    for (const Index v : mirrored.place)
        if (v >= 0)
            rest.closed[at(v)] = 1;
    rest.place = mirrored.place;
    rest.seam = own_half(mirrored, seam, model, graph);
    rest.is_smooth = true;
    return transfer_seams(placed, seam, model, graph, std::vector<double>(model.twin.size(), 1.0),
                          std::move(rest), progress);
}

} // namespace devseg::plush
