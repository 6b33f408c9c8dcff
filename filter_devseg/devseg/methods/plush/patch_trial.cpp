#include "devseg/methods/plush/patch_trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/holes.h"
#include "devseg/base/errors.h"
#include "devseg/flatten/energy/area_balance.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lpfb_map.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/flatten/repair/slits.h"
#include "devseg/methods/plush/tuning.h"
#include "devseg/plane/overlap.h"

namespace devseg::plush {

namespace {

// Nothing where there is no map.
void describe(const atlas::ChartSurface& surface, const flatten::FlatteningProblem& problem,
              const std::vector<Vec2>& uv, PatchTrial& trial) {
    if (uv.empty())
        return;
    trial.face = surface.face;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        trial.change.push_back(flatten::jacobian(problem, uv, f).determinant() - 1.0);
}

// A map of a patch that LPFB cannot map, good enough to see where its area changes; empty where
// needles leave none.
std::vector<Vec2> any_map(const flatten::FlatteningProblem& problem) {
    std::vector<Vec2> uv;
    try {
        uv = flatten::flatten_lscm(problem);
    } catch (const NumericalFailure&) { // needles
    }
    try {
        if (uv.empty() || flatten::count_flips(problem, uv) > 0)
            uv = flatten::flatten_tutte(problem);
    } catch (const NumericalFailure&) {
        return {};
    }
    flatten::scale_to_area(problem, uv);
    return uv;
}

// What is asked of a map once its closed slits are open, as when charts are flattened.
bool lies_flat(const Mesh& mesh, const atlas::ChartSurface& surface,
               const flatten::FlatteningProblem& problem, std::vector<Vec2> uv, double bound) {
    const double size = std::sqrt(mesh.total_area);
    flatten::open_closed_slits(mesh, surface, flatten::slit_gap * size, uv);
    return flatten::measure_area_change(problem, uv).largest() <= bound &&
           flatten::overlapping_pairs(surface, uv, plane::layout_tolerance(size)).empty();
}

// LPFB keeps one boundary; what unfolds exactly needs no LPFB.
PatchTrial try_holes(const Mesh& mesh, const atlas::ChartSurface& surface) {
    PatchTrial trial;
    if (!atlas::is_sound(mesh, surface))
        return trial;
    const auto uv = flatten::unfold(flatten::make_flattening_problem(mesh, surface));
    const double tolerance = plane::layout_tolerance(std::sqrt(mesh.total_area));
    trial.accepted = trial.is_sound =
        uv && flatten::overlapping_pairs(surface, *uv, tolerance).empty();
    return trial;
}

} // namespace

PatchTrial try_patch(const Mesh& mesh, const std::vector<Index>& faces,
                     const std::vector<std::uint8_t>& seam, const PatchLimits& limits, bool details,
                     const Progress& progress) {
    const atlas::ChartSurface surface = atlas::extract_surface(mesh, faces, seam);
    PatchTrial trial;
    if (!surface.is_disk())
        return try_holes(mesh, surface);
    trial.is_sound = true;
    const flatten::FlatteningProblem problem = flatten::make_flattening_problem(mesh, surface);
    const double bound = tuning.used_bound * limits.max_area_change;
    const double strictness = std::min(1.0, limits.max_area_change / tuning.usual_change);
    const double stretch = 1.0 + tuning.most_shear / (limits.is_search ? 2.0 : 1.0);
    flatten::SewingMapOptions options;
    options.enough = bound;
    options.enough_stretch = stretch;
    if (limits.is_search) {
        options.give_up_energy = tuning.hopeless_energy * strictness * strictness;
        options.give_up_overlap = tuning.hopeless_overlap;
    }
    const auto map = flatten::sewing_map(
        problem, surface, plane::layout_tolerance(std::sqrt(mesh.total_area)), options, progress);
    if (map) {
        trial.area_change = map->area_change;
        // At the scale at which the map has the patch's area.
        const double l2 =
            map->l2_stretch * std::sqrt(flatten::map_area(problem, map->uv) / problem.total_area);
        trial.accepted = map->area_change <= bound && l2 <= stretch &&
                         lies_flat(mesh, surface, problem, map->uv, bound);
    }
    if (details)
        describe(surface, problem, map ? map->uv : any_map(problem), trial);
    return trial;
}

PatchTrial conformal_change(const Mesh& mesh, const std::vector<Index>& faces,
                            const std::vector<std::uint8_t>& seam) {
    const atlas::ChartSurface surface = atlas::extract_surface(mesh, faces, seam);
    PatchTrial trial;
    if ((trial.is_sound = surface.is_disk())) {
        const flatten::FlatteningProblem problem = flatten::make_flattening_problem(mesh, surface);
        describe(surface, problem, any_map(problem), trial);
    }
    return trial;
}

bool PatchTester::accepts(const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                          const Progress& progress) {
    std::vector<Index> patch = faces;
    std::sort(patch.begin(), patch.end());
    if (surface_.is_symmetric()) {
        std::vector<Index> image;
        for (const Face f : patch)
            image.push_back(surface_.face_image(f));
        std::sort(image.begin(), image.end());
        patch = std::min(patch, image);
    }
    std::vector<Index> key;
    for (const Face f : patch)
        key.push_back(8 * f + 4 * seam[3 * f] + 2 * seam[3 * f + 1] + seam[3 * f + 2]);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto found = known_.find(key);
        if (found != known_.end())
            return found->second;
    }
    const bool accepted = try_patch(surface_.mesh, patch, seam, limits_, false, progress).accepted;
    const std::lock_guard<std::mutex> lock(mutex_);
    known_.emplace(std::move(key), accepted);
    return accepted;
}

bool PatchTester::accepts_all(const std::vector<std::vector<Index>>& patches,
                              const std::vector<std::uint8_t>& seam, const Progress& progress) {
    return std::all_of(patches.begin(), patches.end(),
                       [&](const auto& faces) { return accepts(faces, seam, progress); });
}

} // namespace devseg::plush
