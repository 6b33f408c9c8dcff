#include "devseg/flatten/one_chart.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/multilevel.h"
#include "devseg/flatten/energy/needles.h"
#include "devseg/flatten/energy/peaks.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/maps/abf.h"
#include "devseg/flatten/maps/arap.h"
#include "devseg/flatten/maps/lpfb.h"
#include "devseg/flatten/maps/lpfb_map.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/flatten/repair/push_apart.h"
#include "devseg/flatten/repair/slits.h"
#include "devseg/plane/overlap.h"

namespace devseg::flatten {

namespace {

// Gap of a slit that readers of texture coordinates certainly see, as a share like slit_gap.
constexpr double visible_gap = 5e-6;

// A face that keeps less of its area has collapsed.
constexpr double collapsed = 1e-5;

// A map this many times larger than the chart is of no use: needles had to be opened to wide
// angles, and the least energy is too far away. The layout would be so large that readers see no
// slits.
constexpr double blown_up = 100.0;

// Coarse-to-fine maps of larger charts are settled around needles and then taken as they are: their
// energy is within 1e-4 of the minimum, and factorizations of the whole chart, to polish it or to
// push its parts away from each other, would cost more than all levels together.
constexpr Index most_polished_faces = 60000;
// Of the chart's size: parts that were pushed apart on a coarse version get finer borders later.
constexpr double coarse_gap = 4e-3;

using Pairs = std::vector<std::pair<Index, Index>>;

// The first map without flips: LSCM, as on all charts that are nearly developable; LPFB; ABF++;
// Tutte, which rounding can flip on long closed tubes.
std::vector<Vec2> valid_start(const FlatteningProblem& problem, const Progress& progress) {
    const std::function<std::vector<Vec2>()> starts[] = {
        [&] { return flatten_lscm(problem); },
        [&] { return flatten_lpfb(problem, LpfbOptions{}, progress).uv; },
        [&] { return flatten_abf(problem, AbfOptions{}, progress).uv; },
        [&] { return flatten_tutte(problem); },
    };
    for (const auto& start : starts) {
        try {
            std::vector<Vec2> uv = start();
            if (count_flips(problem, uv) == 0)
                return uv;
        } catch (const NumericalFailure&) { // the next one may have a solution
        }
    }
    throw NumericalFailure("expected a map without flipped faces, found none for a chart of " +
                           std::to_string(problem.faces.size()) + " faces");
}

std::vector<Vec2> isometric_start(const Mesh& mesh, const atlas::ChartSurface& surface,
                                  const FlatteningProblem& problem, bool& refined,
                                  const Progress& progress) {
    refined = false;
    if (surface.face_count() < multilevel_threshold)
        return valid_start(problem, progress);
    // Parts that lie on each other are pushed apart where that is cheap.
    const auto solve = [&](const FlatteningProblem& coarse, const atlas::ChartSurface& disk) {
        std::vector<Vec2> uv = minimise_symmetric_dirichlet(coarse, valid_start(coarse, progress),
                                                            SymmetricDirichletOptions{}, progress)
                                   .uv;
        const double tolerance = plane::layout_tolerance(std::sqrt(mesh.total_area));
        const Pairs pairs = overlapping_pairs(disk, uv, tolerance);
        if (!pairs.empty() && surface.face_count() > most_polished_faces)
            if (auto apart = push_apart(coarse, disk, uv, pairs, tolerance, progress, coarse_gap))
                uv = std::move(*apart);
        return uv;
    };
    try {
        std::vector<Vec2> uv = flatten_multilevel(mesh, surface, problem, solve, progress);
        refined = count_flips(problem, uv) == 0;
        if (refined)
            return uv;
    } catch (const NumericalFailure&) { // needles can leave no room for a vertex
    }
    return valid_start(problem, progress);
}

void apply_symmetric_dirichlet(const Mesh& mesh, const FlatteningProblem& problem, FlatChart& chart,
                               const Progress& progress) {
    if (problem.faces.size() == 1) { // needles leave a solver no digits, and need none
        const Triangle& t = problem.faces.front();
        chart.uv.assign(3, Vec2::Zero());
        chart.uv[t[1]] = problem.edges.front().col(0);
        chart.uv[t[2]] = problem.edges.front().col(1);
        return;
    }
    bool refined = false;
    chart.uv = isometric_start(mesh, chart.surface, problem, refined, progress);
    if (refined)
        settle_peaks(problem, chart.surface.twin, chart.uv, progress);
    if (!refined || chart.surface.face_count() <= most_polished_faces) {
        SymmetricDirichletResult result =
            minimise_symmetric_dirichlet(problem, chart.uv, SymmetricDirichletOptions{}, progress);
        chart.uv = std::move(result.uv);
        chart.converged = result.converged;
    }
    relieve_peaks(problem, chart.surface.twin, false, chart.uv, progress);
    scale_to_area(problem, chart.uv);
}

// Keeps the lengths of boundary edges. Where no map for sewing is found, the angles are those of
// the nearest isometric map, whatever the areas.
bool apply_lpfb(const Mesh& mesh, const FlatteningProblem& problem, double tolerance,
                FlatChart& chart, const Progress& progress) {
    if (auto map = sewing_map(problem, chart.surface, tolerance, SewingMapOptions{}, progress)) {
        chart.uv = std::move(map->uv);
        return true;
    }
    apply_symmetric_dirichlet(mesh, problem, chart, progress);
    open_closed_slits(mesh, chart.surface, slit_gap * std::sqrt(mesh.total_area), chart.uv);
    auto near = settle_lpfb(
        problem, flatten_lpfb(problem, boundary_angles(problem, chart.uv), LpfbOptions{}, progress),
        progress);
    if (!near)
        return false;
    chart.uv = std::move(near->uv);
    return true;
}

// The method's own map; false where it has flips or cannot be found.
bool apply_method(const Mesh& mesh, const FlatteningProblem& problem, FlattenMethod method,
                  double tolerance, FlatChart& chart, const Progress& progress) {
    try {
        switch (method) {
        case FlattenMethod::symmetric_dirichlet:
            apply_symmetric_dirichlet(mesh, problem, chart, progress);
            return true;
        case FlattenMethod::lscm:
            chart.uv = flatten_lscm(problem);
            break;
        case FlattenMethod::abf: {
            AbfResult result = flatten_abf(problem, AbfOptions{}, progress);
            chart.uv = std::move(result.uv);
            chart.converged = result.converged;
            break;
        }
        case FlattenMethod::arap: {
            ArapResult result =
                minimise_arap(problem, valid_start(problem, progress), ArapOptions{}, progress);
            chart.uv = std::move(result.uv);
            chart.converged = result.converged;
            scale_to_area(problem, chart.uv);
            break;
        }
        case FlattenMethod::lpfb:
            return apply_lpfb(mesh, problem, tolerance, chart, progress);
        }
    } catch (const NumericalFailure&) {
        if (method == FlattenMethod::symmetric_dirichlet)
            throw; // there is nothing else to try
        return false;
    }
    // Conformal maps of strongly curved charts can shrink faces until 32-bit coordinates flip them.
    return count_flips(problem, chart.uv) == 0 && least_area_ratio(problem, chart.uv) > collapsed;
}

std::vector<Index> on_mesh(const atlas::ChartSurface& surface, std::vector<Index> half_edges) {
    for (Index& h : half_edges)
        h = surface.mesh_half_edge(h);
    return half_edges;
}

// The mesh half-edges of a short cut between the first face and the one that is most faces away.
std::vector<Index> halve(const Mesh& mesh, const atlas::ChartSurface& surface) {
    std::vector<std::uint8_t> seen(surface.face.size(), 0);
    std::vector<Index> reached{0};
    seen[0] = 1;
    for (std::size_t i = 0; i < reached.size(); ++i)
        for (const HalfEdge h : half_edges_of(reached[i])) {
            const HalfEdge twin = surface.twin[h];
            if (twin >= 0 && seen[twin / 3] == 0) {
                seen[twin / 3] = 1;
                reached.push_back(twin / 3);
            }
        }
    // A third of the faces on each side takes part, so that the cut is near the middle.
    Pairs pairs{{reached.front(), reached.back()}};
    for (std::size_t i = 0; i < reached.size() / 3; ++i)
        pairs.emplace_back(reached[i], reached[reached.size() - 1 - i]);
    return on_mesh(surface, separating_path(mesh, surface, pairs));
}

// An isometric map of a disk is no longer than half of its boundary.
bool is_blown_up(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double boundary = 0.0;
    for (const double length : problem.boundary_edge)
        boundary += length;
    Eigen::AlignedBox2d box;
    for (const Vec2& p : uv)
        box.extend(p);
    return !(box.diagonal().norm() <= blown_up * (boundary + std::sqrt(problem.total_area)));
}

} // namespace

bool develop(const Mesh& mesh, const FlatteningProblem& problem, FlatChart& chart) {
    auto development = unfold(problem, chart.surface.twin);
    if (!development)
        return false;
    chart.uv = std::move(*development);
    scale_to_area(problem, chart.uv);
    // Slits are opened only where the chart would not be seen as a disk.
    const double size = std::sqrt(mesh.total_area);
    if (closed_slits_hide_disk(mesh, chart.surface, visible_gap * size, chart.uv))
        open_closed_slits(mesh, chart.surface, slit_gap * size, chart.uv);
    chart.developed = true;
    chart.energy = symmetric_dirichlet_energy(problem, chart.uv);
    return true;
}

std::vector<Index> flatten_one(const Mesh& mesh, FlattenMethod method, double tolerance,
                               FlatChart& chart, const Progress& progress) {
    const FlatteningProblem problem = make_flattening_problem(mesh, chart.surface);
    if (develop(mesh, problem, chart)) {
        // It stays as it is: its parts are not pushed apart.
        const Pairs pairs = overlapping_pairs(chart.surface, chart.uv, tolerance);
        return pairs.empty() ? std::vector<Index>{}
                             : on_mesh(chart.surface, separating_path(mesh, chart.surface, pairs));
    }
    try {
        if (!apply_method(mesh, problem, method, tolerance, chart, progress)) {
            chart.mended = true;
            apply_symmetric_dirichlet(mesh, problem, chart, progress);
        }
    } catch (const NumericalFailure&) {
        if (chart.surface.face_count() < 2)
            throw;
        return halve(mesh, chart.surface); // the halves are easier
    }
    if (chart.surface.face_count() > 1 && is_blown_up(problem, chart.uv))
        return halve(mesh, chart.surface);
    restore_needles(mesh, chart.surface, problem, chart.uv);
    open_closed_slits(mesh, chart.surface, slit_gap * std::sqrt(mesh.total_area), chart.uv);
    chart.energy = symmetric_dirichlet_energy(problem, chart.uv);
    const Pairs pairs = overlapping_pairs(chart.surface, chart.uv, tolerance);
    if (pairs.empty())
        return {};
    // Pushing moves the whole map towards the least symmetric Dirichlet energy: other methods' maps
    // would not be theirs any more.
    const bool may_push = (method == FlattenMethod::symmetric_dirichlet || chart.mended) &&
                          chart.surface.face_count() <= most_polished_faces;
    if (auto apart = may_push
                         ? push_apart(problem, chart.surface, chart.uv, pairs, tolerance, progress)
                         : std::nullopt) {
        chart.uv = std::move(*apart);
        relieve_peaks(problem, chart.surface.twin, true, chart.uv, progress);
        open_closed_slits(mesh, chart.surface, slit_gap * std::sqrt(mesh.total_area), chart.uv);
        chart.pushed = true;
        chart.energy = symmetric_dirichlet_energy(problem, chart.uv);
        return {};
    }
    return on_mesh(chart.surface, separating_path(mesh, chart.surface, pairs));
}

} // namespace devseg::flatten
