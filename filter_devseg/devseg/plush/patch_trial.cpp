#include "devseg/plush/patch_trial.h"

#include <algorithm>
#include <cmath>

#include "devseg/errors.h"
#include "devseg/flatten/area_balance.h"
#include "devseg/flatten/lpfb_map.h"
#include "devseg/flatten/lscm.h"
#include "devseg/flatten/map_tools.h"
#include "devseg/flatten/overlaps.h"
#include "devseg/flatten/slits.h"
#include "devseg/flatten/symmetric_dirichlet.h"
#include "devseg/flatten/tutte.h"
#include "devseg/metrics/overlap.h"

namespace devseg {

namespace {

constexpr double kept = 0.98; // share of the bound that is used: maps are rounded to 32 bits later
constexpr double hopeless_energy = 1.6; // of the harmonic map: no later step makes it even
constexpr double most_stretch = 1.15;   // L2: what an even area may cost in shear

double polygon_area(const std::vector<Vec2>& points) {
    double twice = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2& p = points[i];
        const Vec2& q = points[i + 1 < points.size() ? i + 1 : 0];
        twice += p.x() * q.y() - p.y() * q.x();
    }
    return 0.5 * twice;
}

void describe(const ChartSurface& surface, const FlatteningProblem& problem,
              const std::vector<Vec2>& uv, PatchTrial& trial) {
    trial.face = surface.face;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        trial.change.push_back(jacobian(problem, uv, f).determinant() - 1.0);
}

// A map of a patch that LPFB cannot map, good enough to see where its area changes.
std::vector<Vec2> any_map(const FlatteningProblem& problem) {
    std::vector<Vec2> uv = flatten_lscm(problem);
    if (count_flips(problem, uv) > 0)
        uv = flatten_tutte(problem);
    scale_to_area(problem, uv);
    return uv;
}

bool lies_flat(const Mesh& mesh, const ChartSurface& surface, std::vector<Vec2> uv) {
    const double size = std::sqrt(mesh.total_area);
    open_closed_slits(mesh, surface, slit_gap * size, uv);
    return overlapping_pairs(surface, uv, layout_tolerance(size)).empty();
}

} // namespace

PatchTrial try_patch(const Mesh& mesh, const std::vector<Index>& faces,
                     const std::vector<std::uint8_t>& seam, double max_area_change, bool details,
                     const Progress& progress) {
    PatchTrial trial;
    const ChartSurface surface = extract_surface(mesh, faces, seam);
    trial.is_disk = surface.is_disk();
    if (!trial.is_disk)
        return trial;
    const FlatteningProblem problem = make_flattening_problem(mesh, surface);
    try {
        const LpfbOptions options;
        const ClosedBoundary boundary = close_boundary(
            problem.boundary_edge, boundary_angles(problem), options, progress);
        const double whole = polygon_area(boundary.points) / problem.total_area;
        const bool fits = std::abs(whole - 1.0) <= std::min(lpfb_area_change, max_area_change);
        if (fits || details) {
            LpfbResult lpfb = flatten_lpfb(problem, options, progress);
            const bool hopeful = fits && lpfb.flips == 0 &&
                                 symmetric_dirichlet_energy(problem, lpfb.uv) < hopeless_energy;
            if (!hopeful && details)
                describe(surface, problem, lpfb.flips == 0 ? lpfb.uv : any_map(problem), trial);
            if (!hopeful)
                return trial;
            const LpfbMap map = settle_lpfb(problem, std::move(lpfb), progress);
            trial.area_change = measure_area_change(problem, map.uv).largest();
            trial.accepted = trial.area_change <= kept * max_area_change &&
                             is_sewable(problem, map) &&
                             l2_stretch(problem, map.uv) * std::sqrt(whole) <= most_stretch &&
                             lies_flat(mesh, surface, map.uv);
            if (details)
                describe(surface, problem, map.uv, trial);
        }
    } catch (const NumericalFailure&) {
        if (details)
            describe(surface, problem, any_map(problem), trial);
    }
    return trial;
}

} // namespace devseg
