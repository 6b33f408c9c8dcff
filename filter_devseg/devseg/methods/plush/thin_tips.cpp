#include "devseg/methods/plush/thin_tips.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/charts.h"
#include "devseg/methods/plush/mend_patches.h"

namespace devseg::plush {

namespace {

using Line = std::vector<Index>; // half-edges

class NeckCutter {
public:
    NeckCutter(const SeamSetting& setting, SeamMarks& seam, const Progress& progress)
        : s_(setting), mesh_(setting.mesh()), seam_(seam), progress_(progress) {}

    Index run() {
        std::vector<std::uint8_t> is_changed(mesh_.faces.size(), 0);
        for (const Line& patch : patches_of(mesh_, seam_)) {
            const auto changed = [&](Face f) { return is_changed[f] != 0; };
            if (std::any_of(patch.begin(), patch.end(), changed) ||
                s_.tester.judge(patch, seam_, progress_).narrow == 0.0)
                continue;
            const SeamMarks before = seam_;
            cut(patch);
            for (const HalfEdge h : mesh_.all_half_edges())
                if (before[h] != seam_[h])
                    for (const Face f : patches_of(mesh_, before, {face_of(h)}).front())
                        is_changed[f] = 1;
        }
        return tried_;
    }

private:
    // At the first neck where that pays.
    void cut(const Line& patch) {
        const atlas::ChartSurface surface = atlas::extract_surface(mesh_, patch, seam_);
        const judge::ClothTrial trial =
            judge::try_cloth(mesh_, patch, seam_, s_.tester.limits(), false, progress_);
        const auto vertex = [&](std::size_t i) {
            return surface.vertex[surface.origin(surface.loops.front()[i])];
        };
        for (const Neck& neck : find_necks(trial.outline, s_.tester.cost().wide_enough)) {
            const Line path = path_between(surface, vertex(neck.first), vertex(neck.last));
            if (!path.empty() && take_best(ways_of_cutting(path)))
                return;
        }
    }

    // Inside the patch; empty where there is none.
    Line path_between(const atlas::ChartSurface& surface, Vertex start, Vertex end) const {
        if (start == end)
            return {};
        std::vector<std::uint8_t> may_enter(mesh_.points.size(), 0);
        for (const Vertex v : surface.vertex)
            may_enter[v] = 1;
        for (const HalfEdge h : surface.loops.front())
            may_enter[surface.vertex[surface.origin(h)]] = 0;
        may_enter[start] = may_enter[end] = 1;
        const PathTree tree =
            shortest_paths(s_.graph, edge_lengths(mesh_), {start}, progress_, may_enter);
        if (!std::isfinite(tree.distance[end]))
            return {};
        Line path = trace_path(mesh_, tree, end);
        return any_marked(seam_, path) ? Line{} : path;
    }

    // The part beyond the neck as a patch of its own, and as a part of each patch beside it.
    std::vector<SeamMarks> ways_of_cutting(const Line& path) const {
        SeamMarks marks = seam_;
        mark_both(s_.surface, path, 1, marks);
        std::vector<SeamMarks> ways{marks};
        std::vector<Line> parts = patches_beside(mesh_, marks, {path});
        if (parts.size() != 2)
            return ways;
        const auto area = [&](const Line& part) {
            return atlas::area_of(mesh_, atlas::extract_surface(mesh_, part, marks));
        };
        const Line& smaller = area(parts[0]) < area(parts[1]) ? parts[0] : parts[1];
        for (const Line& border : common_borders(mesh_, marks, s_.hard, smaller)) {
            if (std::find_first_of(border.begin(), border.end(), path.begin(), path.end()) !=
                border.end())
                continue; // the patch that it was cut from
            ways.push_back(marks);
            mark_both(s_.surface, border, 0, ways.back());
            for (const Line& joined :
                 patches_beside(mesh_, ways.back(), with_image(s_.surface, {border})))
                open_what_floats(mesh_, s_.hard, joined, ways.back());
        }
        return ways;
    }

    bool take_best(const std::vector<SeamMarks>& ways) {
        double most = 0.0;
        const SeamMarks* best = nullptr;
        for (const SeamMarks& marks : ways) {
            ++tried_;
            progress_.check();
            const double saved = saved_cost(s_, seam_, marks, s_.tester, progress_);
            if (saved > most) {
                most = saved;
                best = &marks;
            }
        }
        if (best != nullptr)
            seam_ = *best;
        return best != nullptr;
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    SeamMarks& seam_;
    const Progress& progress_;
    Index tried_ = 0;
};

} // namespace

Index cut_necks(const SeamSetting& setting, SeamMarks& seam, Progress& progress) {
    return NeckCutter(setting, seam, progress).run();
}

} // namespace devseg::plush
