#include "devseg/flatten/maps/lpfb_map.h"

#include <cmath>
#include <utility>

#include "devseg/flatten/energy/area_balance.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/strain.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/energy/vertex_relaxation.h"
#include "devseg/flatten/maps/arap.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    double most_l2_stretch = 2.0; // [Wan08, section 5]
    // Symmetric Dirichlet energy below which the harmonic inside of an LPFB map stays as it is.
    double harmonic_is_enough = 1.02;
    int isometric_steps = 12; // a start: a few are enough
};
constexpr Tuning tuning;

bool keeps_area(const FlatteningProblem& problem, double area) {
    return std::abs(area / problem.total_area - 1.0) <= usual_area_change;
}

// The map, if it keeps the conditions.
std::optional<LpfbMap> keeping(const atlas::ChartSurface& surface, std::optional<LpfbMap> map,
                               double tolerance) {
    if (map && (map->l2_stretch > tuning.most_l2_stretch ||
                !overlapping_pairs(surface, map->uv, tolerance).empty()))
        map.reset();
    return map;
}

// The map with angles near to the targets, if it keeps the conditions.
std::optional<LpfbMap> map_near(const FlatteningProblem& problem,
                                const atlas::ChartSurface& surface,
                                const std::vector<double>& targets, double tolerance,
                                const Progress& progress) {
    const LpfbOptions options;
    const ClosedBoundary boundary =
        close_boundary(problem.boundary_edge, targets, options, progress);
    if (!keeps_area(problem, plane::signed_area(boundary.points)))
        return std::nullopt;
    return keeping(
        surface, settle_lpfb(problem, flatten_lpfb(problem, targets, options, progress), progress),
        tolerance);
}

double overlapping_share(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                         double tolerance) {
    return static_cast<double>(overlapping_pairs(surface, uv, tolerance).size()) /
           static_cast<double>(surface.face.size());
}

std::optional<LpfbMap> smaller_change(std::optional<LpfbMap> a, std::optional<LpfbMap> b) {
    return !a || (b && b->area_change < a->area_change) ? std::move(b) : std::move(a);
}

// The map with the boundary's lengths nearest to a given one, if it keeps the conditions.
std::optional<LpfbMap> map_beside(const FlatteningProblem& problem,
                                  const atlas::ChartSurface& surface,
                                  const std::vector<Vec2>& start, double tolerance,
                                  const Progress& progress) {
    auto uv = restore_seam_lengths(problem, start, progress);
    if (!uv || !keeps_area(problem, map_area(problem, *uv)))
        return std::nullopt;
    LpfbResult lpfb;
    lpfb.flips = count_flips(problem, *uv);
    lpfb.uv = std::move(*uv);
    return keeping(surface, settle_lpfb(problem, std::move(lpfb), progress), tolerance);
}

// The map beside a nearly isometric one whose areas were evened out while its boundary bends.
std::optional<LpfbMap> bent_map(const FlatteningProblem& problem,
                                const atlas::ChartSurface& surface, double tolerance,
                                const SewingMapOptions& options, const Progress& progress) {
    const auto overlaps = [&](const std::vector<Vec2>& uv, double share) {
        return options.give_up_overlap && overlapping_share(surface, uv, tolerance) > share;
    };
    const std::vector<Vec2> isometric =
        nearly_isometric_map(problem, options.give_up_energy, progress);
    if (isometric.empty() || overlaps(isometric, options.give_up_overlap.value_or(0.0)))
        return std::nullopt;
    const std::vector<Vec2> even = balance_with_boundary(problem, isometric, progress);
    if (overlaps(even, 0.0))
        return std::nullopt;
    return map_beside(problem, surface, even, tolerance, progress);
}

// The map whose boundary has exactly its lengths, beside one that nearly has them.
std::optional<std::vector<Vec2>> with_seam_lengths(const FlatteningProblem& problem,
                                                   const std::vector<Vec2>& near,
                                                   const Progress& progress) {
    auto uv = restore_seam_lengths(problem, near, progress);
    if (uv && !turn_back(problem, *uv))
        uv.reset();
    return uv;
}

} // namespace

std::vector<Vec2> nearly_isometric_map(const FlatteningProblem& problem, double give_up_energy,
                                       const Progress& progress) {
    std::vector<Vec2> start = simple_map(problem);
    if (count_flips(problem, start) > 0)
        return {};
    scale_to_area(problem, start);
    ArapOptions options;
    options.max_rounds = tuning.isometric_steps;
    ArapResult map = minimise_arap(problem, start, options, progress);
    if (map.energy > give_up_energy || (map.flips > 0 && !turn_back(problem, map.uv)))
        return {};
    return map.uv;
}

std::optional<LpfbMap> settle_lpfb(const FlatteningProblem& problem, LpfbResult lpfb,
                                   const Progress& progress) {
    if (lpfb.flips > 0)
        return std::nullopt;
    LpfbMap map;
    map.uv = std::move(lpfb.uv);
    if (symmetric_dirichlet_energy(problem, map.uv) > tuning.harmonic_is_enough) {
        SymmetricDirichletOptions options;
        options.fixed.assign(map.uv.size(), 0);
        for (const Vertex v : problem.boundary)
            options.fixed[v] = 1;
        map.uv = minimise_symmetric_dirichlet(problem, map.uv, options, progress).uv;
    }
    balance_areas(problem, map.uv, progress);
    map.area_change = measure_area_change(problem, map.uv).largest();
    map.l2_stretch = l2_stretch(problem, map.uv);
    return map;
}

std::optional<LpfbMap> sewing_map(const FlatteningProblem& problem,
                                  const atlas::ChartSurface& surface, double tolerance,
                                  const SewingMapOptions& options, const Progress& progress) {
    expect_no_holes(problem);
    const auto is_enough = [&](const std::optional<LpfbMap>& map) {
        return map && map->area_change <= options.enough &&
               map->l2_stretch <= options.enough_stretch;
    };
    // Either pair of angles may have a solution where the other one has none.
    auto own = attempt(
        [&] { return map_near(problem, surface, boundary_angles(problem), tolerance, progress); });
    if (is_enough(own))
        return own;
    auto bent = attempt([&] { return bent_map(problem, surface, tolerance, options, progress); });
    return is_enough(bent) ? bent : smaller_change(std::move(own), std::move(bent));
}

std::optional<LeastStrainMap> least_strain_map(const FlatteningProblem& problem,
                                               const atlas::ChartSurface& surface, double tolerance,
                                               const SewingMapOptions& options,
                                               const Progress& progress) {
    const std::vector<Vec2> isometric =
        nearly_isometric_map(problem, options.give_up_energy, progress);
    if (isometric.empty() ||
        (options.give_up_overlap &&
         overlapping_share(surface, isometric, tolerance) > *options.give_up_overlap))
        return std::nullopt;
    const std::vector<Vec2> bent =
        least_strain_with_boundary(problem, isometric, options.give_up_excess, progress);
    if (bent.empty())
        return std::nullopt;
    auto uv = with_seam_lengths(problem, bent, progress);
    if (!uv)
        return std::nullopt;
    // Without flips, the boundary alone decides whether parts overlap.
    Pairs pairs = overlapping_pairs(surface, *uv, tolerance);
    const bool pushed = !pairs.empty();
    if (pushed) {
        if (!options.push_apart)
            return std::nullopt;
        BoundaryPush pushing(problem, *uv);
        const auto push = [&](const std::vector<Vec2>& start, const ContactPenalty& contacts) {
            return with_seam_lengths(problem, pushing.run(start, contacts, progress), progress)
                .value_or(std::vector<Vec2>());
        };
        uv = push_apart_by(push, problem, surface, std::move(*uv), std::move(pairs), tolerance);
        if (!uv)
            return std::nullopt;
    }
    return LeastStrainMap{least_strain(problem, *uv, progress), pushed};
}

} // namespace devseg::flatten
