#include "devseg/methods/plush/seam_network.h"

#include <algorithm>

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

std::vector<std::uint8_t> border_vertices(const Mesh& mesh, const SeamMarks& seam) {
    std::vector<std::uint8_t> on_border(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (is_border(mesh, seam, h))
            on_border[mesh.origin(h)] = on_border[mesh.target(h)] = 1;
    return on_border;
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

} // namespace devseg::plush
