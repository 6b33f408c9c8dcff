#include "devseg/methods/plush/mend_patches.h"

#include <cmath>
#include <limits>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/area_balance.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lpfb_map.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/overlap.h"

namespace devseg::plush {

namespace {

constexpr int most_cuts = 4;

class Mender {
public:
    Mender(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& cost,
           const SeamMarks& seam, const PatchLimits& limits, const Progress& progress)
        : mesh_(mesh), graph_(graph), cost_(cost), limits_(limits), progress_(progress),
          marks_(seam) {}

    std::optional<std::vector<Index>> mend(const std::vector<Index>& faces) {
        std::vector<std::vector<Index>> open{faces};
        for (int cuts = 0; !open.empty(); ++cuts) {
            const std::vector<Index> patch = open.back();
            open.pop_back();
            const PatchTrial trial = try_patch(mesh_, patch, marks_, limits_, false, progress_);
            if (trial.accepted)
                continue;
            if (!trial.is_disk || cuts >= most_cuts)
                return std::nullopt;
            std::vector<Index> cut = between_sheets(patch, trial.area_change > 0.0);
            if (cut.empty())
                cut = dart(patch);
            if (cut.empty())
                return std::nullopt;
            for (const HalfEdge h : cut) {
                mark(mesh_, h, 1, marks_);
                cuts_.push_back(h);
            }
            for (std::vector<Index>& part : patches_of(mesh_, marks_, patch))
                open.push_back(std::move(part));
        }
        return cuts_;
    }

private:
    std::vector<Index> between_sheets(const std::vector<Index>& patch, bool has_map) const {
        const atlas::ChartSurface surface = atlas::extract_surface(mesh_, patch, marks_);
        std::vector<Index> cut;
        try {
            const auto pairs = overlaps(surface, has_map);
            if (!pairs.empty())
                for (const HalfEdge h : flatten::separating_path(mesh_, surface, pairs, progress_))
                    cut.push_back(surface.mesh_half_edge(h));
        } catch (const NumericalFailure&) { // needles: nothing to learn from
        }
        return cut;
    }

    // Of a nearly isometric map; where the patch has a map, it does not lie on itself once its
    // areas are even.
    std::vector<std::pair<Index, Index>> overlaps(const atlas::ChartSurface& surface,
                                                  bool has_map) const {
        const flatten::FlatteningProblem problem = flatten::make_flattening_problem(mesh_, surface);
        const std::vector<Vec2> uv = flatten::nearly_isometric_map(problem, infinite, progress_);
        if (uv.empty())
            return {};
        const double tolerance = plane::layout_tolerance(std::sqrt(mesh_.total_area));
        auto pairs = flatten::overlapping_pairs(surface, uv, tolerance);
        if (pairs.empty() && !has_map)
            pairs = flatten::overlapping_pairs(
                surface, flatten::balance_with_boundary(problem, uv, progress_), tolerance);
        return pairs;
    }

    std::vector<Index> dart(const std::vector<Index>& patch) const {
        std::vector<std::uint8_t> inside(mesh_.points.size(), 0);
        std::vector<std::uint8_t> on_border(mesh_.points.size(), 0);
        for (const Face f : patch)
            for (const HalfEdge h : half_edges_of(f)) {
                inside[mesh_.origin(h)] = 1;
                if (marks_[h] != 0 || mesh_.twin[h] < 0)
                    on_border[mesh_.origin(h)] = on_border[mesh_.target(h)] = 1;
            }
        const Index tip = shrunk_vertex(conformal_change(mesh_, patch, marks_), on_border);
        if (tip < 0)
            return {};
        const PathTree tree = shortest_paths(graph_, cost_, {tip}, progress_, inside, on_border);
        Index end = -1;
        for (std::size_t v = 0; v < on_border.size(); ++v)
            if (on_border[v] != 0 && std::isfinite(tree.distance[v]) &&
                (end < 0 || tree.distance[v] < tree.distance[end]))
                end = static_cast<Index>(v);
        if (end < 0)
            return {};
        return trace_path(mesh_, tree, end);
    }

    // The inner vertex where the map shrinks most; −1 where nothing lies inside.
    Index shrunk_vertex(const PatchTrial& map, const std::vector<std::uint8_t>& on_border) const {
        std::vector<double> area(mesh_.points.size(), 0.0);
        std::vector<double> flat_area(mesh_.points.size(), 0.0);
        for (std::size_t i = 0; i < map.face.size(); ++i)
            for (const Vertex v : mesh_.faces[map.face[i]]) {
                area[v] += mesh_.face_areas[map.face[i]];
                flat_area[v] += mesh_.face_areas[map.face[i]] * (1.0 + map.change[i]);
            }
        Index least = -1;
        for (std::size_t v = 0; v < area.size(); ++v)
            if (area[v] > 0.0 && on_border[v] == 0 &&
                (least < 0 || flat_area[v] * area[least] < flat_area[least] * area[v]))
                least = static_cast<Index>(v);
        return least;
    }

    const Mesh& mesh_;
    const VertexGraph& graph_;
    const std::vector<double>& cost_;
    const PatchLimits limits_;
    const Progress& progress_;
    SeamMarks marks_;
    std::vector<Index> cuts_;
};

} // namespace

std::optional<std::vector<Index>> mend_patch(const Mesh& mesh, const VertexGraph& graph,
                                             const std::vector<double>& cost,
                                             const std::vector<Index>& faces, const SeamMarks& seam,
                                             const PatchLimits& limits, const Progress& progress) {
    return Mender(mesh, graph, cost, seam, limits, progress).mend(faces);
}

} // namespace devseg::plush
