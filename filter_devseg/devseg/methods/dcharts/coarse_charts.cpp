#include "devseg/methods/dcharts/coarse_charts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/fragments.h"
#include "devseg/flatten/flatten.h"
#include "devseg/methods/dcharts/draft.h"
#include "devseg/methods/growth/borders.h"

namespace devseg::dcharts {

namespace {

constexpr Index coarse_faces = 6000;          // enough to decide where borders run
constexpr Index creased_coarse_faces = 24000; // where they must run along creases
constexpr Index faces_per_chart = 150;        // of the coarse surface, at least
constexpr int most_split_rounds = 24;
constexpr double worth_coarsening = 2.0; // faces over those of the coarse surface

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

} // namespace

WorkingSurface::WorkingSurface(const Mesh& full, bool creased, Index charts, Progress& progress)
    : full_(full), creased_(creased) {
    const Index wanted =
        std::max(creased ? creased_coarse_faces : coarse_faces, faces_per_chart * charts);
    if (full.face_count() <= worth_coarsening * wanted)
        return;
    coarse_ = mesh::coarsen_in_parallel(full, wanted, progress);
}

FullCharts WorkingSurface::carry_over(const Draft& draft, const std::vector<Index>& patch,
                                      double max_fitting_error, Straightening straightening,
                                      Progress& progress) const {
    FullCharts result;
    result.seam = draft.seam;
    result.darts = static_cast<Index>(draft.tips.size());
    result.chart =
        coarse_ ? mesh::refine_labels(full_, *coarse_, draft.chart, progress) : draft.chart;
    straighten(draft, patch, max_fitting_error, straightening, result.chart, progress);
    if (coarse_ || straightening != Straightening::none) {
        result.chart = atlas::absorb_fragments(full_, result.chart, fragment_share);
        progress.check();
        result.seam.assign(full_.twin.size(), 0);
        result.darts = cut_darts_to(full_, result.chart, tips_of(draft), result.seam);
    }
    progress.check();
    result.chart = atlas::make_chart_map(full_, result.chart, result.seam, false).chart;
    progress.check();
    return result;
}

// A strip of about one edge of the coarse surface is too narrow to change the shape of a chart by
// much.
void WorkingSurface::straighten(const Draft& draft, const std::vector<Index>& patch,
                                double max_fitting_error, Straightening straightening,
                                std::vector<Index>& chart, Progress& progress) const {
    const bool fitting = straightening != Straightening::none && coarse_;
    const bool smooth = straightening == Straightening::smooth && !creased_;
    if (!fitting && !smooth)
        return;
    const growth::ChartProxies proxies = proxies_of_charts(mesh(), draft, patch);
    const double ratio = static_cast<double>(full_.face_count()) / mesh().face_count();
    const int edge = static_cast<int>(std::sqrt(ratio)); // of the coarse surface, in faces
    if (fitting)
        growth::straighten_borders(full_, proxies, max_fitting_error, 2 + 2 * edge, chart,
                                   progress);
    if (smooth)
        growth::straighten_borders(full_, proxies, infinite, 1 + edge, chart, progress);
}

std::vector<Index> WorkingSurface::tips_of(const Draft& draft) const {
    if (!coarse_)
        return draft.tips;
    std::vector<Index> tips;
    for (const Vertex v : draft.tips)
        tips.push_back(coarse_->vertex[v]);
    return tips;
}

Index WorkingSurface::cut_more_darts(const DartOptions& options, const std::vector<Index>& chart,
                                     std::vector<std::uint8_t>& seam, Progress& progress) const {
    Draft draft = make_draft(full_, chart, seam, options.chart.l2, progress);
    const Index count = cut_darts(full_, options, draft, progress);
    seam = draft.seam;
    return count;
}

FinalStretch WorkingSurface::measure(const std::vector<Index>& chart,
                                     const std::vector<std::uint8_t>& seam,
                                     Progress& progress) const {
    auto cutting = progress.part("measuring the final map", 0.1);
    const atlas::ChartMap charts =
        atlas::cut_charts_to_disks(full_, atlas::make_chart_map(full_, chart, seam, false), cutting)
            .charts;
    auto flattening = progress.part("measuring the final map", 0.9);
    FinalStretch reached;
    reached.all = {1.0, 1.0};
    reached.linf.assign(at(1 + *std::max_element(chart.begin(), chart.end())), 1.0);
    double excess = 0.0;
    for (const flatten::FlatChart& flat :
         flatten::flatten_charts(full_, charts, flatten::FlattenMethod::symmetric_dirichlet,
                                 flattening)
             .flat) {
        judge::TrialMap map;
        judge::measure_stretch(flatten::make_flattening_problem(full_, flat.surface), flat.uv, map);
        excess += map.excess();
        reached.all.linf = std::max(reached.all.linf, map.linf);
        double& linf = reached.linf[chart[flat.surface.face.front()]];
        linf = std::max(linf, map.linf);
    }
    reached.all.l2 = std::sqrt(1.0 + std::max(0.0, excess) / full_.total_area);
    return reached;
}

FinalStretch WorkingSurface::split_above(double linf, const DChartsOptions& options,
                                         std::vector<Index>& chart, std::vector<std::uint8_t>& seam,
                                         Progress& progress) const {
    auto measuring = progress.part(0.2);
    FinalStretch reached = measure(chart, seam, measuring);
    // Every round makes charts smaller; these many take a whole surface apart into faces.
    for (int round = 0; round < most_split_rounds && reached.all.linf > linf; ++round) {
        auto splitting = progress.part(0.2 * progress.left());
        Draft draft = make_untried_draft(full_, chart);
        draft.seam = seam;
        bool changed = false;
        for (std::size_t c = 0; c < reached.linf.size(); ++c)
            if (reached.linf[c] > linf) {
                const Index worst = static_cast<Index>(c);
                changed |= split_chart(full_, options, linf, worst, draft, splitting) ||
                           halve_chart(full_, linf, worst, draft, splitting);
            }
        if (!changed)
            break;
        seam = draft.seam;
        chart = atlas::make_chart_map(full_, draft.chart, seam, false).chart;
        auto again = progress.part(0.2 * progress.left());
        reached = measure(chart, seam, again);
    }
    return reached;
}

std::vector<double> WorkingSurface::fitting_errors(const std::vector<Index>& chart) const {
    const Index count = 1 + *std::max_element(chart.begin(), chart.end());
    const std::vector<metrics::ConicProxy> proxies = metrics::fit_conics(full_, chart, count);
    std::vector<double> errors(full_.faces.size());
    for (std::size_t f = 0; f < errors.size(); ++f)
        errors[f] = proxies[chart[f]].fitting_error(full_.face_normals[f]);
    return errors;
}

} // namespace devseg::dcharts
