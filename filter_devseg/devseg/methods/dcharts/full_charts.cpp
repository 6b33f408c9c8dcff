#include "devseg/methods/dcharts/full_charts.h"

#include <algorithm>
#include <cmath>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/fragments.h"
#include "devseg/flatten/flatten.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/borders.h"

namespace devseg::dcharts {

namespace {

// What faces fit in each chart: the proxies of all patches that it was joined from.
growth::ChartProxies proxies_of_charts(const Mesh& mesh, const Draft& draft,
                                       const std::vector<Index>& patch) {
    const Index patches = 1 + *std::max_element(patch.begin(), patch.end());
    const std::vector<metrics::ConicProxy> proxies = metrics::fit_conics(mesh, patch, patches);
    growth::ChartProxies result(draft.faces.size());
    std::vector<std::uint8_t> seen(proxies.size() * draft.faces.size(), 0);
    for (std::size_t f = 0; f < patch.size(); ++f) {
        std::uint8_t& known = seen[at(patch[f]) * draft.faces.size() + at(draft.chart[f])];
        if (known == 0)
            result[draft.chart[f]].push_back(proxies[patch[f]]);
        known = 1;
    }
    return result;
}

// A strip of about one edge of the coarse surface is too narrow to change the shape of a chart by
// much.
void straighten(const Mesh& mesh, const Mesh& coarse, const Draft& draft,
                const std::vector<Index>& patch, double max_fitting_error,
                Straightening straightening, std::vector<Index>& chart, Progress& progress) {
    const bool fitting = straightening != Straightening::none && &mesh != &coarse;
    const bool smooth = straightening == Straightening::smooth;
    if (!fitting && !smooth)
        return;
    const growth::ChartProxies proxies = proxies_of_charts(coarse, draft, patch);
    const double ratio = static_cast<double>(mesh.face_count()) / coarse.face_count();
    const int edge = static_cast<int>(std::sqrt(ratio)); // of the coarse surface, in faces
    if (fitting)
        growth::straighten_borders(mesh, proxies, max_fitting_error, 2 + 2 * edge, chart, progress);
    if (smooth)
        growth::straighten_borders(mesh, proxies, infinite, 1 + edge, chart, progress);
}

} // namespace

std::optional<mesh::CoarseMesh> decimate(const Mesh& mesh, bool creased, Index charts,
                                         Progress& progress) {
    const Index wanted = std::max(creased ? tuning.decimated_creased_faces : tuning.decimated_faces,
                                  tuning.faces_per_chart * charts);
    if (mesh.face_count() <= tuning.worth_decimation * wanted)
        return {};
    return mesh::coarsen_in_parallel(mesh, wanted, progress);
}

DevelopableCharts transfer(const Mesh& mesh, const std::optional<mesh::CoarseMesh>& decimation,
                           const Draft& draft, const std::vector<Index>& patch,
                           double max_fitting_error, Straightening straightening,
                           Progress& progress) {
    DevelopableCharts result;
    result.chart =
        decimation ? mesh::refine_labels(mesh, *decimation, draft.chart, progress) : draft.chart;
    straighten(mesh, decimation ? decimation->mesh : mesh, draft, patch, max_fitting_error,
               straightening, result.chart, progress);
    result.seam = draft.seam;
    result.darts = static_cast<Index>(draft.tips.size());
    if (decimation || straightening != Straightening::none) {
        result.chart = atlas::absorb_fragments(mesh, result.chart, tuning.least_chart);
        progress.check();
        std::vector<Index> tips = draft.tips;
        for (Index& tip : tips)
            tip = decimation ? decimation->vertex[tip] : tip;
        result.seam.assign(mesh.twin.size(), 0);
        result.darts = cut_darts_to(mesh, result.chart, tips, result.seam);
    }
    progress.check();
    result.chart = atlas::make_chart_map(mesh, result.chart, result.seam, false).chart;
    progress.check();
    return result;
}

std::vector<double> measure_stretch(const Mesh& mesh, DevelopableCharts& charts,
                                    Progress& progress) {
    auto cutting = progress.part("measuring the final map", 0.1);
    const atlas::ChartMap disks =
        atlas::cut_charts_to_disks(
            mesh, atlas::make_chart_map(mesh, charts.chart, charts.seam, false), cutting)
            .charts;
    auto flattening = progress.part("measuring the final map", 0.9);
    std::vector<double> linf(at(1 + *std::max_element(charts.chart.begin(), charts.chart.end())),
                             1.0);
    double excess = 0.0;
    for (const flatten::FlatChart& flat :
         flatten::flatten_charts(mesh, disks, flatten::FlattenMethod::symmetric_dirichlet,
                                 flattening)
             .flat) {
        judge::TrialMap map;
        judge::measure_stretch(flatten::make_flattening_problem(mesh, flat.surface), flat.uv, map);
        excess += map.excess();
        double& worst = linf[charts.chart[flat.surface.face.front()]];
        worst = std::max(worst, map.linf);
    }
    charts.l2_stretch = std::sqrt(1.0 + std::max(0.0, excess) / mesh.total_area);
    charts.linf_stretch = *std::max_element(linf.begin(), linf.end());
    return linf;
}

void cut_more_darts(const Mesh& mesh, const DartOptions& options, DevelopableCharts& charts,
                    Progress& progress) {
    Draft draft = make_draft(mesh, charts.chart, charts.seam, options.chart.l2, progress);
    charts.darts += cut_darts(mesh, options, draft, progress);
    charts.seam = draft.seam;
}

void split_above(const Mesh& mesh, double linf, const DChartsOptions& options,
                 DevelopableCharts& charts, Progress& progress) {
    auto measuring = progress.part(0.2);
    std::vector<double> reached = measure_stretch(mesh, charts, measuring);
    while (charts.linf_stretch > linf) { // every round makes charts smaller, down to single faces
        auto splitting = progress.part(0.2 * progress.left());
        Draft draft = make_untried_draft(mesh, charts.chart);
        draft.seam = charts.seam;
        bool changed = false;
        for (Index c = 0; c < static_cast<Index>(reached.size()); ++c)
            if (reached[c] > linf)
                changed |= split_chart(mesh, options, linf, c, draft, splitting) ||
                           halve_chart(mesh, linf, c, draft, splitting);
        if (!changed)
            break;
        charts.seam = draft.seam;
        charts.chart = atlas::make_chart_map(mesh, draft.chart, charts.seam, false).chart;
        auto again = progress.part(0.2 * progress.left());
        reached = measure_stretch(mesh, charts, again);
    }
}

} // namespace devseg::dcharts
