#include "devseg/methods/plush/seam_smoothing.h"

#include <algorithm>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/methods/plush/seam_guides.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// An open part of a segment, which is made straight between its ends.
struct Line {
    std::vector<Index> half_edges; // head to tail
    bool may_slide = false;        // its end, along the plane, where the mirror image goes on
};

class Straightener {
public:
    Straightener(const SeamSetting& setting, SeamMarks& seam, Progress& progress)
        : s_(setting), mesh_(setting.mesh()), seam_(seam), progress_(progress), cost_(seam.size()),
          side_(mesh_.points.size(), 0), on_plane_(mesh_.points.size(), 0) {
        for (const HalfEdge h : mesh_.all_half_edges()) {
            cost_[h] = s_.straight_cost[h];
            side_[mesh_.origin(h)] = s_.surface.is_symmetric() && s_.surface.image[h] < h;
            on_plane_[mesh_.origin(h)] = s_.surface.starts_on_plane(h) ? 1 : 0;
        }
    }

    void run() {
        // Loops have other ends the second time.
        for (const int turn : {0, 1}) {
            const std::vector<Line> lines = find_lines(turn);
            for (std::size_t i = 0; i < lines.size(); ++i) {
                progress_.update(0.5 * turn +
                                 0.5 * static_cast<double>(i) / static_cast<double>(lines.size()));
                const std::vector<Index> path = shorter_path(lines[i]);
                if (!path.empty())
                    replace(lines[i].half_edges, path);
            }
        }
    }

private:
    std::vector<Line> find_lines(int turn) const {
        std::vector<Line> lines;
        std::vector<std::uint8_t> done(seam_.size(), 0);
        for (const SeamSegment& segment : find_segments(mesh_, seam_, s_.hard, s_.weight)) {
            const std::vector<Index>& line = segment.half_edges;
            if (segment.is_hard || line.size() < 3 || s_.surface.is_on_plane(line.front()) ||
                done[line.front()] != 0)
                continue;
            if (s_.surface.is_symmetric())
                for (const HalfEdge h : line) {
                    const Index image = s_.surface.image[h];
                    done[image] = done[mesh_.twin[image]] = 1;
                }
            if (segment.is_loop)
                split_loop(line, turn, lines);
            else
                lines.push_back(up_to_plane(line));
        }
        return lines;
    }

    Line up_to_plane(const std::vector<Index>& line) const {
        for (std::size_t k = 1; k < line.size(); ++k)
            if (on_plane_[mesh_.origin(line[k])] != 0)
                return {{line.begin(), line.begin() + static_cast<std::ptrdiff_t>(k)}, true};
        return {line, false};
    }

    // Where it crosses the plane, the part on one side; else two halves.
    void split_loop(std::vector<Index> line, int turn, std::vector<Line>& lines) const {
        const auto crosses = [&](HalfEdge h) { return on_plane_[mesh_.origin(h)] != 0; };
        auto first = std::find_if(line.begin(), line.end(), crosses);
        const bool is_crossing = first != line.end();
        if (!is_crossing)
            first = line.begin() + turn * static_cast<std::ptrdiff_t>(line.size()) / 4;
        std::rotate(line.begin(), first, line.end());
        auto middle = line.begin() + static_cast<std::ptrdiff_t>(line.size() / 2);
        if (is_crossing)
            middle = std::find_if(line.begin() + 1, line.end(), crosses);
        lines.push_back({{line.begin(), middle}, false});
        if (!is_crossing)
            lines.push_back({{middle, line.end()}, false});
    }

    // Vertices near the line, on its side of the plane, that are on no other seam.
    std::vector<std::uint8_t> corridor(const std::vector<Index>& line) const {
        std::vector<std::uint8_t> near(mesh_.points.size(), 0);
        std::vector<Index> ring;
        for (const HalfEdge h : line)
            for (const Vertex v : {mesh_.origin(h), mesh_.target(h)})
                if (near[v] == 0) {
                    near[v] = 1;
                    ring.push_back(v);
                }
        const std::uint8_t side =
            s_.surface.is_symmetric() && s_.surface.image[line.front()] < line.front();
        for (int k = 0; k < tuning.corridor_rings; ++k) {
            std::vector<Index> next;
            for (const Vertex v : ring)
                for (Index i = s_.graph.begin[v]; i < s_.graph.begin[at(v) + 1]; ++i) {
                    const Index u = s_.graph.vertex[i];
                    if (near[u] != 0 || is_on_seam(u, seam_) ||
                        (side_[u] != side && on_plane_[u] == 0))
                        continue;
                    near[u] = 1;
                    next.push_back(u);
                }
            ring = std::move(next);
        }
        return near;
    }

    // Empty if there is none.
    std::vector<Index> shorter_path(const Line& whole) const {
        const std::vector<Index>& line = whole.half_edges;
        double before = 0.0;
        for (const HalfEdge h : line) {
            if (seam_[h] == 0)
                return {}; // another line took its place
            before += cost_[h];
        }
        const Index start = mesh_.origin(line.front());
        Index end = mesh_.target(line.back());
        if (start == end)
            return {};
        const std::vector<std::uint8_t> near = corridor(line);
        // Paths end where they reach the plane.
        const PathTree tree = shortest_paths(s_.graph, cost_, {start}, progress_, near, on_plane_);
        for (std::size_t v = 0; v < near.size() && whole.may_slide; ++v)
            if (on_plane_[v] != 0 && near[v] != 0 && tree.distance[v] < tree.distance[end])
                end = static_cast<Index>(v);
        if (!(tree.distance[end] < tuning.path_worth * before))
            return {};
        return trace_path(mesh_, tree, end);
    }

    bool is_on_seam(Vertex v, const SeamMarks& seam) const {
        for (Index i = s_.graph.begin[v]; i < s_.graph.begin[at(v) + 1]; ++i)
            if (is_border(mesh_, seam, s_.graph.half_edge[i]))
                return true;
        return false;
    }

    // Whether the new path meets no seam but at its ends.
    bool is_free(const std::vector<Index>& line, const std::vector<Index>& path,
                 const SeamMarks& without) const {
        for (const HalfEdge h : path)
            for (const Vertex v : {mesh_.origin(h), mesh_.target(h)}) {
                const bool is_end =
                    v == mesh_.origin(line.front()) || v == mesh_.target(line.back());
                if (!is_end && is_on_seam(v, without))
                    return false;
            }
        return true;
    }

    void replace(const std::vector<Index>& line, const std::vector<Index>& path) {
        SeamMarks marks = seam_;
        mark_both(s_.surface, line, 0, marks);
        if (!is_free(line, path, marks))
            return;
        mark_both(s_.surface, path, 1, marks);
        if (keeps_patches(line, path, marks))
            seam_ = std::move(marks);
    }

    bool keeps_patches(const std::vector<Index>& line, const std::vector<Index>& path,
                       const SeamMarks& marks) const {
        // As they would be.
        const auto parts = patches_beside(mesh_, marks, {line, path});
        std::vector<std::uint8_t> fits(parts.size(), 0);
        parallel_for(
            static_cast<int>(parts.size()),
            [&](int i) {
                const auto k = static_cast<std::size_t>(i);
                fits[k] = s_.tester.accepts(parts[k], marks, progress_) ? 1 : 0;
            },
            progress_);
        return std::find(fits.begin(), fits.end(), 0) == fits.end();
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    SeamMarks& seam_;
    Progress& progress_;
    std::vector<double> cost_;           // 3 #F
    std::vector<std::uint8_t> side_;     // #V: 1 on the mirror image
    std::vector<std::uint8_t> on_plane_; // #V
};

} // namespace

void straighten_seams(const SeamSetting& setting, SeamMarks& seam, Progress& progress) {
    Straightener(setting, seam, progress).run();
}

} // namespace devseg::plush
