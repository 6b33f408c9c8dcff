#include "devseg/methods/plush/seam_network.h"

#include <algorithm>

namespace devseg::plush {

namespace {

bool is_hard_edge(const SeamMarks& hard, Index h) {
    return !hard.empty() && hard[at(h)] != 0;
}

class SegmentWalker {
public:
    SegmentWalker(const Mesh& mesh, const SeamMarks& seam, const SeamMarks& hard)
        : mesh_(mesh), hard_(hard), leaving_(mesh.points.size()), done_(seam.size(), 0),
          is_end_(mesh.points.size(), 0) {
        std::vector<Index> degree(mesh.points.size(), 0);
        for (Index h = 0; h < mesh.half_edge_count(); ++h) {
            if (mesh.twin[at(h)] < 0)
                is_end_[at(mesh.origin(h))] = is_end_[at(mesh.target(h))] = 1;
            if (mesh.twin[at(h)] < 0 || seam[at(h)] == 0)
                continue;
            leaving_[at(mesh.origin(h))].push_back(h);
            ++degree[at(mesh.origin(h))];
        }
        for (std::size_t v = 0; v < degree.size(); ++v)
            if (degree[v] != 2 ||
                is_hard_edge(hard, leaving_[v][0]) != is_hard_edge(hard, leaving_[v][1]))
                is_end_[v] = 1;
    }

    bool is_done(Index h) const { return done_[at(h)] != 0; }
    bool starts_at_end(Index h) const { return is_end_[at(mesh_.origin(h))] != 0; }

    SeamSegment walk(Index h) {
        SeamSegment segment;
        segment.is_hard = is_hard_edge(hard_, h);
        segment.is_loop = !starts_at_end(h);
        while (h >= 0 && done_[at(h)] == 0) {
            done_[at(h)] = done_[at(mesh_.twin[at(h)])] = 1;
            segment.half_edges.push_back(h);
            const Index v = mesh_.target(h);
            if (is_end_[at(v)] != 0)
                break;
            const Index back = mesh_.twin[at(h)];
            const std::vector<Index>& out = leaving_[at(v)];
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

void mark(const Mesh& mesh, Index half_edge, std::uint8_t value, SeamMarks& seam) {
    if (mesh.twin[at(half_edge)] < 0)
        return;
    seam[at(half_edge)] = seam[at(mesh.twin[at(half_edge)])] = value;
}

std::vector<SeamSegment> find_segments(const Mesh& mesh, const SeamMarks& seam,
                                       const SeamMarks& hard, const std::vector<double>& weight) {
    SegmentWalker walker(mesh, seam, hard);
    std::vector<SeamSegment> segments;
    for (const bool loops : {false, true})
        for (Index h = 0; h < mesh.half_edge_count(); ++h)
            if (seam[at(h)] != 0 && mesh.twin[at(h)] >= 0 && !walker.is_done(h) &&
                (loops || walker.starts_at_end(h)))
                segments.push_back(walker.walk(h));
    for (SeamSegment& segment : segments) {
        for (const Index h : segment.half_edges) {
            segment.length += mesh.edge_length(h);
            segment.weight += weight[at(h)];
        }
        segment.weight /= static_cast<double>(segment.half_edges.size());
    }
    return segments;
}

std::vector<Index> seam_degrees(const Mesh& mesh, const SeamMarks& seam) {
    std::vector<Index> degree(mesh.points.size(), 0);
    for (Index h = 0; h < mesh.half_edge_count(); ++h) {
        if (mesh.twin[at(h)] >= 0 && (seam[at(h)] == 0 || mesh.twin[at(h)] < h))
            continue;
        ++degree[at(mesh.origin(h))];
        ++degree[at(mesh.target(h))];
    }
    return degree;
}

std::vector<std::vector<Index>> patches_of(const Mesh& mesh, const SeamMarks& seam,
                                           const std::vector<Index>& faces) {
    std::vector<std::vector<Index>> patches;
    std::vector<std::uint8_t> seen(mesh.faces.size(), 0);
    for (const Index start : faces) {
        if (seen[at(start)] != 0)
            continue;
        std::vector<Index> patch{start};
        seen[at(start)] = 1;
        for (std::size_t k = 0; k < patch.size(); ++k)
            for (Index h = 3 * patch[k]; h < 3 * patch[k] + 3; ++h) {
                const Index twin = mesh.twin[at(h)];
                if (twin >= 0 && seam[at(h)] == 0 && seen[at(twin / 3)] == 0) {
                    seen[at(twin / 3)] = 1;
                    patch.push_back(twin / 3);
                }
            }
        std::sort(patch.begin(), patch.end());
        patches.push_back(std::move(patch));
    }
    return patches;
}

mesh::FaceComponents find_patches(const Mesh& mesh, const SeamMarks& seam) {
    return mesh::face_components(mesh, [&](Index h) { return seam[at(h)] == 0; });
}

} // namespace devseg::plush
