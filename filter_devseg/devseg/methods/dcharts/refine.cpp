#include "devseg/methods/dcharts/refine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/slit_closing.h"
#include "devseg/judge/roughness.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/methods/dcharts/bounds.h"
#include "devseg/methods/dcharts/joins.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/borders.h"
#include "devseg/metrics/conic_proxy.h"

namespace devseg::dcharts {

namespace {

constexpr int straightened_rings = 4; // faces beside a border: more would change charts by much

Index count_of(const std::vector<Index>& chart) {
    return 1 + *std::max_element(chart.begin(), chart.end());
}

// Marks of cuts inside charts.
std::vector<std::uint8_t> inner_cuts(const Mesh& mesh, const atlas::ChartMap& given) {
    std::vector<std::uint8_t> seam = given.seam;
    for (const HalfEdge h : mesh.all_half_edges())
        if (const Face g = mesh.across(h); g < 0 || given.chart[face_of(h)] != given.chart[g])
            seam[h] = 0;
    return seam;
}

// Vertices where cuts end inside a chart.
std::vector<Index> tips_of(const Mesh& mesh, const atlas::ChartMap& given) {
    const std::vector<Index> degree = atlas::cut_edges_at_vertices(mesh, given.seam);
    const std::vector<std::uint8_t> boundary = mesh::boundary_vertices(mesh);
    std::vector<Index> tips;
    for (const Vertex v : mesh.all_vertices())
        if (degree[v] == 1 && boundary[v] == 0)
            tips.push_back(v);
    return tips;
}

void straighten(const Mesh& mesh, const atlas::ChartMap& given, DevelopableCharts& charts,
                Progress& progress) {
    growth::ChartProxies proxies;
    for (const metrics::ConicProxy& proxy : metrics::fit_conics(mesh, given.chart, given.count))
        proxies.push_back({proxy});
    const Index moved =
        growth::straighten_borders(mesh, proxies, DChartsOptions().max_fitting_error,
                                   straightened_rings, charts.chart, progress);
    if (moved == 0)
        return;
    charts.seam.assign(mesh.twin.size(), 0);
    cut_darts_to(mesh, charts.chart, tips_of(mesh, given), charts.seam);
    charts.chart = atlas::make_chart_map(mesh, charts.chart, charts.seam, true).chart;
}

FinalBounds bounds_of(const Mesh& mesh, const RefineOptions& options, double roughness) {
    FinalBounds bounds;
    bounds.chart_l2 = options.max_chart_l2_stretch;
    bounds.linf = options.max_linf_stretch;
    bounds.roughness = roughness > tuning.rough ? roughness : 0.0;
    bounds.add_darts = options.add_darts;
    if (options.max_l2_stretch > 0.0)
        bounds.max_excess =
            (options.max_l2_stretch * options.max_l2_stretch - 1.0) * mesh.total_area;
    return bounds;
}

MergeOptions merging_of(const Mesh& mesh, const FinalBounds& bounds) {
    MergeOptions merging;
    if (bounds.chart_l2 > 0.0)
        merging.chart.l2 = std::sqrt(
            1.0 + tuning.certain * (bounds.chart_l2 * bounds.chart_l2 - 1.0) + bounds.roughness);
    merging.chart.hard_l2 = bounds.chart_l2 > 0.0 ? merging.chart.l2 : infinite;
    merging.chart.linf = bounds.linf > 0.0 ? bounds.linf : infinite;
    merging.max_excess = bounds.max_excess;
    merging.confirm = true;
    merging.parts_above = mesh.face_count(); // whole borders alone
    return merging;
}

void join(const Mesh& mesh, const MergeOptions& merging, DevelopableCharts& charts,
          Progress& progress) {
    auto trying = progress.part("trying charts", 0.2);
    Draft draft = make_draft(mesh, charts.chart, charts.seam, merging.chart.l2, trying);
    auto joining = progress.part("joining charts", 0.8);
    merge_charts(mesh, merging, draft, joining);
    charts.joins += draft.joins;
    charts.seam = std::move(draft.seam);
    charts.chart = atlas::make_chart_map(mesh, draft.chart, charts.seam, false).chart;
}

} // namespace

OptionRanges<RefineOptions> RefineOptions::ranges() {
    using O = RefineOptions;
    return {{&O::max_chart_l2_stretch, {"max_chart_l2_stretch", 0.0, 100.0}},
            {&O::max_linf_stretch, {"max_linf_stretch", 0.0, 1000.0}},
            {&O::max_l2_stretch, {"max_l2_stretch", 0.0, 100.0}}};
}

DevelopableCharts refine_charts(const Mesh& mesh, const atlas::ChartMap& given,
                                const RefineOptions& options, Progress& progress) {
    check_ranges(options);
    for (const auto& [name, bound] :
         {std::pair("max_chart_l2_stretch", options.max_chart_l2_stretch),
          std::pair("max_linf_stretch", options.max_linf_stretch),
          std::pair("max_l2_stretch", options.max_l2_stretch)})
        if (bound != 0.0 && bound <= 1.0)
            refuse_option(name, "0 for no bound, or a number above 1", bound);
    DevelopableCharts charts;
    charts.chart = given.chart;
    charts.seam = inner_cuts(mesh, given);
    charts.standing.assign(mesh.faces.size(), Standing::kept);
    charts.converged = true;
    auto feeling = progress.part("measuring roughness", 0.1);
    charts.roughness = judge::roughness(mesh, feeling).excess;
    auto straightening = progress.part("straightening borders", 0.1);
    if (options.straighten_boundaries)
        straighten(mesh, given, charts, straightening);
    const FinalBounds bounds = bounds_of(mesh, options, charts.roughness);
    const MergeOptions merging = merging_of(mesh, bounds);
    auto joining = progress.part(0.3);
    if (options.merge_charts)
        join(mesh, merging, charts, joining);
    auto keeping = progress.part(progress.left());
    if (bounds.chart_l2 > 0.0 || bounds.linf > 0.0 || bounds.max_excess < infinite)
        keep_bounds(mesh, bounds, DChartsOptions(), merging, charts, keeping);
    charts.bounds_kept = std::all_of(charts.standing.begin(), charts.standing.end(),
                                     [](Standing standing) { return standing == Standing::kept; });
    charts.fitting_error = fitting_errors(
        mesh, charts.chart, metrics::fit_conics(mesh, charts.chart, count_of(charts.chart)));
    return charts;
}

} // namespace devseg::dcharts
