#include "devseg/flatten/lpfb_map.h"

#include <cmath>
#include <limits>
#include <utility>

#include "devseg/flatten/area_balance.h"
#include "devseg/flatten/map_tools.h"
#include "devseg/flatten/symmetric_dirichlet.h"

namespace devseg {

namespace {
constexpr double lpfb_stretch = 2.0;
// Symmetric Dirichlet energy below which the harmonic inside of an LPFB map stays as it is.
constexpr double harmonic_is_enough = 1.02;
} // namespace

LpfbMap settle_lpfb(const FlatteningProblem& problem, LpfbResult lpfb, const Progress& progress) {
    if (lpfb.flips > 0)
        return {std::numeric_limits<double>::infinity(), {}};
    LpfbMap map{symmetric_dirichlet_energy(problem, lpfb.uv), std::move(lpfb.uv)};
    if (map.energy > harmonic_is_enough) {
        SymmetricDirichletOptions options;
        options.fixed.assign(map.uv.size(), 0);
        for (const Index v : problem.boundary)
            options.fixed[at(v)] = 1;
        map.uv = minimise_symmetric_dirichlet(problem, map.uv, options, progress).uv;
    }
    balance_areas(problem, map.uv, progress);
    map.energy = symmetric_dirichlet_energy(problem, map.uv);
    return map;
}

bool is_sewable(const FlatteningProblem& problem, const LpfbMap& map) {
    return std::isfinite(map.energy) &&
           std::abs(map_area(problem, map.uv) / problem.total_area - 1.0) <= lpfb_area_change &&
           l2_stretch(problem, map.uv) <= lpfb_stretch;
}

} // namespace devseg
