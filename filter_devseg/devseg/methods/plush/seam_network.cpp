#include "devseg/methods/plush/seam_network.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "devseg/graph/shortest_paths.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

class SegmentWalker {
public:
    SegmentWalker(const Mesh& mesh, const SeamMarks& seam, const SeamMarks& hard)
        : mesh_(mesh), hard_(hard), leaving_(mesh.points.size()), done_(seam.size(), 0),
          is_end_(mesh.points.size(), 0) {
        std::vector<Index> degree(mesh.points.size(), 0);
        for (const HalfEdge h : mesh.all_half_edges()) {
            if (mesh.twin[h] < 0)
                is_end_[mesh.origin(h)] = is_end_[mesh.target(h)] = 1;
            if (mesh.twin[h] < 0 || seam[h] == 0)
                continue;
            leaving_[mesh.origin(h)].push_back(h);
            ++degree[mesh.origin(h)];
        }
        for (std::size_t v = 0; v < degree.size(); ++v)
            if (degree[v] != 2 ||
                is_marked(hard, leaving_[v][0]) != is_marked(hard, leaving_[v][1]))
                is_end_[v] = 1;
    }

    bool is_done(HalfEdge h) const { return done_[h] != 0; }
    bool starts_at_end(HalfEdge h) const { return is_end_[mesh_.origin(h)] != 0; }

    SeamSegment walk(HalfEdge h) {
        SeamSegment segment;
        segment.is_hard = is_marked(hard_, h);
        segment.is_loop = !starts_at_end(h);
        while (h >= 0 && done_[h] == 0) {
            done_[h] = done_[mesh_.twin[h]] = 1;
            segment.half_edges.push_back(h);
            const Vertex v = mesh_.target(h);
            if (is_end_[v] != 0)
                break;
            const Index back = mesh_.twin[h];
            const std::vector<Index>& out = leaving_[v];
            h = out[0] == back ? out[1] : out[0];
        }
        return segment;
    }

private:
    const Mesh& mesh_;
    const SeamMarks& hard_;
    std::vector<std::vector<Index>> leaving_; // #V: seam half-edges
    std::vector<std::uint8_t> done_;          // 3 #F
    std::vector<std::uint8_t> is_end_;        // #V
};

} // namespace

void mark(const Mesh& mesh, HalfEdge half_edge, std::uint8_t value, SeamMarks& seam) {
    if (mesh.twin[half_edge] < 0)
        return;
    seam[half_edge] = seam[mesh.twin[half_edge]] = value;
}

void mark(const Mesh& mesh, const std::vector<Index>& line, std::uint8_t value, SeamMarks& seam) {
    for (const HalfEdge h : line)
        mark(mesh, h, value, seam);
}

bool any_marked(const SeamMarks& marks, const std::vector<Index>& line) {
    return std::any_of(line.begin(), line.end(), [&](HalfEdge h) { return is_marked(marks, h); });
}

std::vector<std::uint8_t> border_vertices(const Mesh& mesh, const SeamMarks& seam) {
    std::vector<std::uint8_t> on_border(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (is_border(mesh, seam, h))
            on_border[mesh.origin(h)] = on_border[mesh.target(h)] = 1;
    return on_border;
}

std::vector<double> edge_lengths(const Mesh& mesh) {
    std::vector<double> lengths;
    for (const HalfEdge h : mesh.all_half_edges())
        lengths.push_back(mesh.edge_length(h));
    return lengths;
}

double mean_edge_length(const Mesh& mesh) {
    const std::vector<double> lengths = edge_lengths(mesh);
    return std::accumulate(lengths.begin(), lengths.end(), 0.0) /
           std::max<Index>(1, mesh.half_edge_count());
}

double length_of(const Mesh& mesh, const std::vector<Index>& line) {
    double length = 0.0;
    for (const HalfEdge h : line)
        length += mesh.edge_length(h);
    return length;
}

std::vector<SeamSegment> find_segments(const Mesh& mesh, const SeamMarks& seam,
                                       const SeamMarks& hard, const std::vector<double>& weight) {
    SegmentWalker walker(mesh, seam, hard);
    std::vector<SeamSegment> segments;
    for (const bool loops : {false, true})
        for (const HalfEdge h : mesh.all_half_edges())
            if (seam[h] != 0 && mesh.twin[h] >= 0 && !walker.is_done(h) &&
                (loops || walker.starts_at_end(h)))
                segments.push_back(walker.walk(h));
    for (SeamSegment& segment : segments) {
        segment.length = length_of(mesh, segment.half_edges);
        for (const HalfEdge h : segment.half_edges)
            segment.weight += weight.empty() ? 0.0 : weight[h];
        segment.weight /= static_cast<double>(segment.half_edges.size());
    }
    return segments;
}

std::vector<Index> seam_degrees(const Mesh& mesh, const SeamMarks& seam) {
    std::vector<Index> degree(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (mesh.twin[h] >= 0 && (seam[h] == 0 || mesh.twin[h] < h))
            continue;
        ++degree[mesh.origin(h)];
        ++degree[mesh.target(h)];
    }
    return degree;
}

std::vector<std::vector<Index>> patches_of(const Mesh& mesh, const SeamMarks& seam,
                                           const std::vector<Index>& faces) {
    std::vector<std::vector<Index>> patches;
    std::vector<std::uint8_t> seen(mesh.faces.size(), 0);
    for (const Index start : faces) {
        if (seen[start] != 0)
            continue;
        std::vector<Index> patch{start};
        seen[start] = 1;
        for (std::size_t k = 0; k < patch.size(); ++k)
            for (const HalfEdge h : half_edges_of(patch[k])) {
                const HalfEdge twin = mesh.twin[h];
                if (twin >= 0 && seam[h] == 0 && seen[face_of(twin)] == 0) {
                    seen[face_of(twin)] = 1;
                    patch.push_back(face_of(twin));
                }
            }
        std::sort(patch.begin(), patch.end());
        patches.push_back(std::move(patch));
    }
    return patches;
}

std::vector<std::vector<Index>> patches_of(const Mesh& mesh, const SeamMarks& seam) {
    const mesh::FaceComponents patches = find_patches(mesh, seam);
    std::vector<std::vector<Index>> faces(at(patches.count));
    for (const Face f : mesh.all_faces())
        faces[patches.label[f]].push_back(f);
    return faces;
}

std::vector<std::vector<Index>> patches_beside(const Mesh& mesh, const SeamMarks& seam,
                                               const std::vector<std::vector<Index>>& lines) {
    std::vector<Index> start;
    for (const std::vector<Index>& line : lines)
        for (const HalfEdge h : line)
            start.insert(start.end(), {face_of(h), face_of(mesh.twin[h])});
    return patches_of(mesh, seam, start);
}

mesh::FaceComponents find_patches(const Mesh& mesh, const SeamMarks& seam) {
    return mesh::face_components(mesh, [&](HalfEdge h) { return seam[h] == 0; });
}

VertexGraph build_vertex_graph(const Mesh& mesh) {
    std::vector<std::array<Index, 3>> links; // vertex, neighbour, half-edge
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] < h) {
            links.push_back({mesh.origin(h), mesh.target(h), h});
            links.push_back({mesh.target(h), mesh.origin(h), h});
        }
    std::sort(links.begin(), links.end());
    VertexGraph graph;
    graph.begin.assign(mesh.points.size() + 1, 0);
    for (const auto& [v, u, h] : links) {
        ++graph.begin[at(v) + 1];
        graph.vertex.push_back(u);
        graph.half_edge.push_back(h);
    }
    std::partial_sum(graph.begin.begin(), graph.begin.end(), graph.begin.begin());
    return graph;
}

PathTree shortest_paths(const VertexGraph& graph, const std::vector<double>& weight,
                        const std::vector<Index>& sources, const Progress& progress,
                        const std::vector<std::uint8_t>& may_enter,
                        const std::vector<std::uint8_t>& is_goal) {
    graph::ShortestPaths<> paths(graph.begin.size() - 1);
    for (const Vertex v : sources)
        paths.add_source(v);
    paths.run(
        [&](Vertex v, double distance) {
            if (distance > 0.0 && !is_goal.empty() && is_goal[v] != 0)
                return;
            for (Index i = graph.begin[v]; i < graph.begin[at(v) + 1]; ++i)
                if (may_enter.empty() || may_enter[graph.vertex[i]] != 0)
                    paths.reach(graph.vertex[i], distance + weight[graph.half_edge[i]],
                                graph.half_edge[i]);
        },
        progress);
    return {std::move(paths.distance), std::move(paths.step)};
}

std::vector<Index> trace_path(const Mesh& mesh, const PathTree& tree, Vertex vertex) {
    std::vector<Index> path;
    while (tree.half_edge[vertex] >= 0 && tree.distance[vertex] > 0.0) {
        const HalfEdge h = tree.half_edge[vertex];
        path.push_back(h);
        vertex = mesh.origin(h) == vertex ? mesh.target(h) : mesh.origin(h);
    }
    return path;
}

void add_structural_seams(const Mesh& mesh, const VertexGraph& graph,
                          const std::vector<double>& weight, const std::vector<Index>& ends,
                          SeamMarks& seam, Progress& progress) {
    std::vector<double> cost = weight;
    for (const HalfEdge h : mesh.all_half_edges())
        if (seam[h] != 0)
            cost[h] *= tuning.shared_seam;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        progress.update(static_cast<double>(i) / static_cast<double>(ends.size()));
        const PathTree tree = shortest_paths(graph, cost, {ends[i]}, progress);
        for (std::size_t j = i + 1; j < ends.size(); ++j)
            for (const HalfEdge h : trace_path(mesh, tree, ends[j])) {
                if (seam[h] == 0)
                    for (const HalfEdge side : {h, mesh.twin[h]})
                        if (side >= 0)
                            cost[side] = tuning.shared_seam * weight[side];
                mark(mesh, h, 1, seam);
            }
    }
}

} // namespace devseg::plush
