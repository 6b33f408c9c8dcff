#include "devseg/plush/seam_smoothing.h"

#include <algorithm>
#include <array>

#include "devseg/parallel.h"
#include "devseg/plush/patch_trial.h"

namespace devseg {

namespace {

constexpr int most_rounds = 12;   // of taking teeth away
constexpr int corridor_rings = 3; // of vertices beside a segment
constexpr double worth = 0.97;    // of its cost: what a new path must save
constexpr double natural_share =
    0.3; // of the seam weight in the cost of an edge, beside its length

class Straightener {
public:
    Straightener(const SeamSetting& setting, const VertexGraph& graph, SeamMarks& seam,
                 Progress& progress)
        : s_(setting), graph_(graph), seam_(seam), progress_(progress), cost_(seam.size()) {
        for (Index h = 0; h < s_.mesh.half_edge_count(); ++h)
            cost_[at(h)] =
                s_.mesh.edge_length(h) * (1.0 - natural_share + natural_share * s_.weight[at(h)]);
    }

    Index run() {
        Index replaced = 0;
        const std::vector<SeamSegment> segments = find_segments(s_.mesh, seam_, s_.hard, s_.weight);
        std::vector<std::vector<Index>> paths(segments.size());
        parallel_for(
            static_cast<int>(segments.size()),
            [&](int i) {
                const auto k = static_cast<std::size_t>(i);
                if (!segments[k].is_hard && !segments[k].is_loop &&
                    segments[k].half_edges.size() > 2)
                    paths[k] = shorter_path(segments[k]);
            },
            progress_);
        for (std::size_t i = 0; i < segments.size(); ++i) {
            progress_.update(static_cast<double>(i) / static_cast<double>(segments.size()));
            if (!paths[i].empty() && replace(segments[i], paths[i]))
                ++replaced;
        }
        return replaced;
    }

private:
    // Through vertices near the segment that are on no other seam; empty if there is none.
    std::vector<Index> shorter_path(const SeamSegment& segment) const {
        const Mesh& mesh = s_.mesh;
        std::vector<std::uint8_t> near(mesh.points.size(), 0);
        std::vector<Index> ring;
        double before = 0.0;
        for (const Index h : segment.half_edges) {
            before += cost_[at(h)];
            for (const Index v : {mesh.origin(h), mesh.target(h)})
                if (near[at(v)] == 0) {
                    near[at(v)] = 1;
                    ring.push_back(v);
                }
        }
        for (int k = 0; k < corridor_rings; ++k) {
            std::vector<Index> next;
            for (const Index v : ring)
                for (Index i = graph_.begin[at(v)]; i < graph_.begin[at(v) + 1]; ++i) {
                    const Index u = graph_.vertex[at(i)];
                    if (near[at(u)] == 0 && !is_on_seam(u)) {
                        near[at(u)] = 1;
                        next.push_back(u);
                    }
                }
            ring = std::move(next);
        }
        const Index start = mesh.origin(segment.half_edges.front());
        const Index end = mesh.target(segment.half_edges.back());
        if (start == end)
            return {};
        const PathTree tree = shortest_paths(graph_, cost_, {start}, near);
        if (!(tree.distance[at(end)] < worth * before))
            return {};
        return trace_path(mesh, tree, end);
    }

    bool is_on_seam(Index v) const {
        for (Index i = graph_.begin[at(v)]; i < graph_.begin[at(v) + 1]; ++i) {
            const Index h = graph_.half_edge[at(i)];
            if (seam_[at(h)] != 0 || s_.mesh.twin[at(h)] < 0)
                return true;
        }
        return false;
    }

    // Whether the new path meets no seam but at its ends.
    bool is_free(const SeamSegment& segment, const std::vector<Index>& path,
                 const SeamMarks& without) const {
        const Index start = s_.mesh.origin(segment.half_edges.front());
        const Index end = s_.mesh.target(segment.half_edges.back());
        for (const Index h : path)
            for (const Index v : {s_.mesh.origin(h), s_.mesh.target(h)}) {
                if (v == start || v == end)
                    continue;
                for (Index i = graph_.begin[at(v)]; i < graph_.begin[at(v) + 1]; ++i) {
                    const Index e = graph_.half_edge[at(i)];
                    if (without[at(e)] != 0 || s_.mesh.twin[at(e)] < 0)
                        return false;
                }
            }
        return true;
    }

    bool replace(const SeamSegment& segment, const std::vector<Index>& path) {
        SeamMarks marks = seam_;
        for (const Index h : segment.half_edges)
            mark(s_.mesh, h, 0, marks);
        if (!is_free(segment, path, marks))
            return false;
        for (const Index h : path)
            mark(s_.mesh, h, 1, marks);
        // The patches beside the old and the new line, as they would be.
        std::vector<Index> start;
        for (const Index h : path)
            for (const Index side : {h, s_.mesh.twin[at(h)]})
                start.push_back(side / 3);
        const std::vector<std::vector<Index>> parts = patches_of(s_.mesh, marks, start);
        std::vector<std::uint8_t> fits(parts.size(), 0);
        parallel_for(
            static_cast<int>(parts.size()),
            [&](int i) {
                const auto k = static_cast<std::size_t>(i);
                fits[k] = try_patch(s_.mesh, parts[k], marks, s_.max_area_change, false, progress_)
                                  .accepted
                              ? 1
                              : 0;
            },
            progress_);
        if (std::find(fits.begin(), fits.end(), 0) != fits.end())
            return false;
        seam_ = std::move(marks);
        return true;
    }

    const SeamSetting& s_;
    const VertexGraph& graph_;
    SeamMarks& seam_;
    Progress& progress_;
    std::vector<double> cost_; // 3 #F
};

} // namespace

void remove_teeth(const Mesh& mesh, std::vector<Index>& label) {
    for (int round = 0; round < most_rounds; ++round) {
        bool changed = false;
        for (Index f = 0; f < mesh.face_count(); ++f) {
            std::array<Index, 3> other{-1, -1, -1};
            for (std::size_t k = 0; k < 3; ++k) {
                const Index twin = mesh.twin[at(3 * f) + k];
                if (twin >= 0 && label[at(twin / 3)] != label[at(f)])
                    other[k] = label[at(twin / 3)];
            }
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t n = (k + 1) % 3;
                if (other[k] < 0 || other[k] != other[n] || other[(k + 2) % 3] == other[k])
                    continue;
                label[at(f)] = other[k];
                changed = true;
                break;
            }
        }
        if (!changed)
            return;
    }
}

Index straighten_seams(const SeamSetting& setting, const VertexGraph& graph, SeamMarks& seam,
                       Progress& progress) {
    return Straightener(setting, graph, seam, progress).run();
}

} // namespace devseg
