#include "devseg/flatten/coarse_map.h"

#include <numeric>
#include <utility>

#include "devseg/atlas/holes.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/multilevel.h"
#include "devseg/flatten/energy/vertex_relaxation.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/one_chart.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/flatten/repair/slits.h"
#include "devseg/flatten/repair/snap.h"
#include "devseg/plane/overlap.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    // Of a chart's size, between parts that were pushed apart: at half of it, more of them touch
    // again when they are refined, and have to be pushed on all faces.
    double wide_gap = 8e-3;
};
constexpr Tuning tuning;

// The map with its overlapping parts far apart; nothing where that fails.
std::optional<std::vector<Vec2>> push_far(const FlatteningProblem& problem,
                                          const atlas::ChartSurface& surface,
                                          const std::vector<Vec2>& uv, const Progress& progress) {
    const double tolerance = plane::layout_tolerance(problem.model_size);
    const Pairs pairs = overlapping_pairs(surface, uv, tolerance);
    if (pairs.empty())
        return uv;
    return push_apart(problem, surface, uv, pairs, tolerance, progress, tuning.wide_gap);
}

} // namespace

CoarseMap map_coarsely(
    const Mesh& mesh, const atlas::ChartSurface& surface, Index most_faces,
    const std::function<bool(const FlatteningProblem&, const std::vector<Vec2>&)>& may_push,
    const Progress& progress) {
    CoarseMap map;
    map.chart = atlas::mesh_of(mesh, surface);
    map.coarse = mesh::coarsen(map.chart, most_faces, progress);
    const Mesh& coarse = map.coarse.mesh;
    std::vector<Index> all(coarse.faces.size());
    std::iota(all.begin(), all.end(), 0);
    FlatChart& flat = map.flat;
    flat.surface = atlas::extract_surface(coarse, std::move(all),
                                          std::vector<std::uint8_t>(coarse.twin.size(), 0));
    flat.torn = true;
    if (!atlas::is_sound(coarse, flat.surface)) // a hole that lies flat on all faces only
        return map;
    flat.torn = false;
    WholeChart whole;
    whole.push_apart = false;
    flatten_one(coarse, FlattenMethod::symmetric_dirichlet, flat, progress, &whole);
    if (!flat.torn || flat.uv.empty() || flat.developed)
        return map;
    const FlatteningProblem problem = make_flattening_problem(coarse, flat.surface);
    if (!may_push(problem, flat.uv))
        return map;
    if (auto apart = push_far(problem, flat.surface, flat.uv, progress)) {
        flat.uv = std::move(*apart);
        flat.pushed = true;
        flat.torn = false;
    }
    return map;
}

std::optional<std::vector<Vec2>> refine_coarse_map(const Mesh& mesh,
                                                   const atlas::ChartSurface& surface,
                                                   const FlatteningProblem& problem,
                                                   CoarseMap coarse, const Progress& progress) {
    const FlatChart& flat = coarse.flat;
    if (flat.torn || largest_defect(problem) <= exact_angle || unfold(problem))
        return std::nullopt;
    std::vector<Vec2> uv(coarse.chart.points.size(), Vec2::Zero());
    for (const Vertex v : flat.surface.all_vertices())
        uv[coarse.coarse.vertex[flat.surface.vertex[v]]] = flat.uv[v];
    uv = refine_map(coarse.chart, std::move(coarse.coarse.surface), std::move(uv), problem,
                    flat.pushed, progress);
    if (!flat.pushed) // parts would come together again
        settle_peaks(problem, uv, progress);
    relieve_peaks(problem, flat.pushed, uv, progress);
    scale_to_area(problem, uv);
    restore_needles(problem, uv);
    open_closed_slits(mesh, surface, slit_gap * problem.model_size, uv);
    auto apart = push_far(problem, surface, uv, progress);
    if (!apart || count_flips(problem, *apart) > 0 ||
        overlaps_itself(surface, *apart, plane::layout_tolerance(problem.model_size)))
        return std::nullopt;
    return apart;
}

std::optional<std::vector<Vec2>> map_by_coarse(const Mesh& mesh, const atlas::ChartSurface& surface,
                                               const FlatteningProblem& problem,
                                               const Progress& progress) {
    if (surface.face_count() <= coarse_map_faces)
        return std::nullopt;
    const auto may_push = [](const FlatteningProblem&, const std::vector<Vec2>&) { return true; };
    return attempt([&] {
        return refine_coarse_map(mesh, surface, problem,
                                 map_coarsely(mesh, surface, coarse_map_faces, may_push, progress),
                                 progress);
    });
}

} // namespace devseg::flatten
