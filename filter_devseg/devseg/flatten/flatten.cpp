#include "devseg/flatten/flatten.h"

#include <algorithm>
#include <numeric>

#include "devseg/errors.h"
#include "devseg/flatten/lscm.h"
#include "devseg/flatten/map_tools.h"
#include "devseg/flatten/symmetric_dirichlet.h"
#include "devseg/flatten/tutte.h"
#include "devseg/parallel.h"

namespace devseg {

namespace {

// LSCM where it is free of flips, as on all charts that are nearly developable; Tutte elsewhere.
std::vector<Vec2> valid_start(const FlatteningProblem& problem, const std::vector<Vec2>& lscm) {
    if (count_flips(problem, lscm) == 0)
        return lscm;
    std::vector<Vec2> uv = flatten_tutte(problem);
    if (count_flips(problem, uv) > 0)
        throw NumericalFailure("expected a map without flipped faces, found none for a chart of " +
                               std::to_string(problem.faces.size()) +
                               " faces; use more charts, or remesh the model "
                               "('Remeshing: Isotropic Explicit Remeshing')");
    return uv;
}

void flatten_one(const Mesh& mesh, FlattenMethod method, FlatChart& chart,
                 const Progress& progress) {
    const FlatteningProblem problem = make_flattening_problem(mesh, chart.surface);
    chart.uv = flatten_lscm(problem);
    const bool flips = count_flips(problem, chart.uv) > 0;
    chart.mended = method == FlattenMethod::lscm && flips;
    if (method == FlattenMethod::symmetric_dirichlet || flips) {
        SymmetricDirichletResult result = minimise_symmetric_dirichlet(
            problem, valid_start(problem, chart.uv), SymmetricDirichletOptions{}, progress);
        chart.uv = std::move(result.uv);
        chart.converged = result.converged;
        scale_to_area(problem, chart.uv);
    }
    chart.energy = symmetric_dirichlet_energy(problem, chart.uv);
}

} // namespace

std::vector<FlatChart> flatten_charts(const Mesh& mesh, const ChartMap& charts,
                                      FlattenMethod method, Progress& progress) {
    std::vector<ChartSurface> surfaces = extract_charts(mesh, charts);
    std::vector<FlatChart> result(surfaces.size());
    for (std::size_t c = 0; c < surfaces.size(); ++c)
        result[c].surface = std::move(surfaces[c]);
    // The largest first, so that no core is left with a large chart at the end.
    std::vector<std::size_t> order(result.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return result[a].surface.face.size() > result[b].surface.face.size();
    });
    parallel_for(
        static_cast<int>(order.size()),
        [&](int i) {
            FlatChart& chart = result[order[static_cast<std::size_t>(i)]];
            progress.check();
            flatten_one(mesh, method, chart, progress);
        },
        progress);
    return result;
}

} // namespace devseg
