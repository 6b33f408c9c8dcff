#include "devseg/methods/dcharts/developable_charts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "devseg/judge/roughness.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/dcharts/deciding.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/metrics/conic_proxy.h"

namespace devseg::dcharts {

namespace {

// From isometry, in bounds: at most 1 where they are kept.
double distance(const DevelopableChartsOptions& options, const DevelopableCharts& charts) {
    const auto excess = [](double stretch) { return stretch * stretch - 1.0; };
    const double l2 = excess(charts.l2_stretch) / excess(options.max_l2_stretch);
    return options.max_linf_stretch == 0.0
               ? l2
               : std::max(l2, excess(charts.linf_stretch) / excess(options.max_linf_stretch));
}

// Splits the charts that contribute most until the stretch of all leaves room for joins.
void split_worst(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim, Draft& draft,
                 Progress& progress) {
    std::vector<std::uint8_t> whole; // charts that could not be split
    for (int i = 0;
         i < tuning.most_splits && draft.excess() > tuning.room_for_joins * aim.max_excess; ++i) {
        whole.resize(draft.faces.size(), 0);
        Index worst = -1;
        for (Index c = 0; c < static_cast<Index>(draft.faces.size()); ++c)
            if (!draft.faces[c].empty() && whole[c] == 0 &&
                (worst < 0 || draft.map[c].excess() > draft.map[worst].excess()))
                worst = c;
        if (worst < 0)
            return;
        if (!split_chart(mesh, plan.growing, aim.chart.l2, worst, draft, progress))
            whole[worst] = 1;
    }
}

// The fewest charts within the bounds: found on the coarse surface for growing shares of the
// allowed stretch. The final map of the full surface decides how much may be used. Where even the
// smallest share is too much for it, charts are cut.
DevelopableCharts find_fewest(const Mesh& mesh, const std::optional<mesh::CoarseMesh>& decimation,
                              const SegmentationPlan& plan, const DChartsResult& patches,
                              double roughness, Progress& progress) {
    const DevelopableChartsOptions& options = plan.options;
    const Mesh& coarse = decimation ? decimation->mesh : mesh;
    const double allowed = options.max_l2_stretch * options.max_l2_stretch - 1.0;
    Aim aim;
    aim.few = true;
    aim.chart.l2 = std::sqrt(1.0 + tuning.chart_excess * allowed);
    aim.chart.linf = options.max_linf_stretch > 0.0
                         ? options.max_linf_stretch
                         : bounds_from(tuning.loose_linf * (options.max_l2_stretch - 1.0)).linf;
    if (options.max_linf_stretch > 0.0)
        aim.chart.hard_linf = options.max_linf_stretch;
    aim.max_excess = tuning.shares.front() * allowed * coarse.total_area;
    auto trying = progress.part("trying charts", 0.04);
    Decided decided{patches, make_draft(coarse, patches.chart, {}, options.max_l2_stretch, trying)};
    auto splitting = progress.part("splitting charts", 0.04);
    split_worst(coarse, plan, aim, decided.draft, splitting);
    std::vector<double> shares;
    for (const double share : tuning.shares)
        shares.push_back(share * allowed * coarse.total_area);
    auto improving = progress.part(0.6 * progress.left());
    std::vector<Draft> drafts =
        improve(coarse, plan, aim, shares, std::move(decided.draft), improving);
    aim.max_excess = shares.back();
    while (true) {
        decided.draft = std::move(drafts.back());
        drafts.pop_back();
        auto finishing = progress.part(0.1 * progress.left());
        DevelopableCharts found =
            finish(mesh, decimation, plan, decided, Straightening::smooth, finishing);
        found.roughness = roughness;
        auto keeping = progress.part((drafts.empty() ? 1.0 : 0.5) * progress.left());
        if (!keep_final_bounds(mesh, plan, aim, drafts.empty(), found, keeping) && !drafts.empty())
            continue;
        found.bounds_kept = distance(options, found) <= 1.0;
        return found;
    }
}

// A surface in one piece.
DevelopableCharts segment_component(const Mesh& mesh, const DevelopableChartsOptions& options,
                                    Progress& progress) {
    if (mesh::flat_regions(mesh).count == 1) {
        DevelopableCharts sheet;
        sheet.chart.assign(mesh.faces.size(), 0);
        sheet.seam.assign(mesh.twin.size(), 0);
        sheet.standing.assign(mesh.faces.size(), Standing::kept);
        sheet.converged = true;
        sheet.l2_stretch = sheet.linf_stretch = options.charts_number == 0 ? 1.0 : 0.0;
        return sheet;
    }
    SegmentationPlan plan = make_plan(mesh, options);
    auto coarsening = progress.part("coarsening", 0.06);
    const std::optional<mesh::CoarseMesh> decimation = decimate(
        mesh, plan.creased, std::max(options.charts_number, tuning.automatic_seeds), coarsening);
    const Mesh& coarse = decimation ? decimation->mesh : mesh;
    auto feeling = progress.part("measuring roughness", 0.02);
    const judge::Roughness rough = judge::roughness(mesh, feeling);
    const judge::Roughness of_coarse = decimation ? judge::roughness(coarse, feeling) : rough;
    if (is_rough(of_coarse.excess))
        plan.rough = of_coarse;
    auto growing = progress.part(0.15);
    DChartsResult patches = grow_patches(coarse, plan, growing);
    if (options.charts_number == 0) {
        auto deciding = progress.part(progress.left());
        return find_fewest(mesh, decimation, plan, patches, rough.excess, deciding);
    }
    auto deciding = progress.part(0.6);
    DevelopableCharts result =
        finish(mesh, decimation, plan, decide(coarse, plan, std::move(patches), deciding),
               Straightening::smooth, deciding);
    result.roughness = rough.excess;
    auto keeping = progress.part(progress.left());
    keep_final_bounds(mesh, plan, aim_of(plan), true, result, keeping);
    return result;
}

void add_up(const DevelopableCharts& part, DevelopableCharts& whole) {
    whole.rounds = std::max(whole.rounds, part.rounds);
    whole.converged = whole.converged && part.converged;
    whole.hole_charts += part.hole_charts;
    whole.joins += part.joins;
    whole.darts += part.darts;
    whole.linf_stretch = std::max(whole.linf_stretch, part.linf_stretch);
    whole.strain.take_worse(part.strain);
    whole.bounds_kept = whole.bounds_kept && part.bounds_kept;
}

// The parts of a surface, one after the other, each with its share of the charts.
DevelopableCharts segment_components(const Mesh& mesh, const mesh::FaceComponents& components,
                                     const DevelopableChartsOptions& options, Progress& progress) {
    DevelopableCharts result;
    result.converged = true;
    result.chart.resize(mesh.faces.size());
    result.seam.assign(mesh.twin.size(), 0);
    result.standing.assign(mesh.faces.size(), Standing::kept);
    double excess = 0.0;
    Index first = 0; // number of the component's first chart
    const atlas::ChartMap whole{components.label, result.seam, components.count};
    for (const atlas::ChartSurface& surface : atlas::extract_charts(mesh, whole)) {
        const std::vector<Index>& faces = surface.face;
        const Mesh part = atlas::mesh_of(mesh, surface);
        const double share = part.total_area / mesh.total_area;
        DevelopableChartsOptions own = options;
        if (options.charts_number > 0)
            own.charts_number = std::clamp(
                static_cast<int>(std::lround(options.charts_number * share)), 1, part.face_count());
        auto segmenting = progress.part(share);
        const DevelopableCharts charts = segment_component(part, own, segmenting);
        for (const Face f : part.all_faces()) {
            result.chart[faces[f]] = first + charts.chart[f];
            result.standing[faces[f]] = charts.standing[f];
        }
        result.roughness += share * charts.roughness;
        for (const HalfEdge h : part.all_half_edges())
            result.seam[surface.mesh_half_edge(h)] = charts.seam[h];
        first += 1 + *std::max_element(charts.chart.begin(), charts.chart.end());
        add_up(charts, result);
        excess += (charts.l2_stretch * charts.l2_stretch - 1.0) * part.total_area;
    }
    result.chart = atlas::make_chart_map(mesh, result.chart, result.seam, false).chart;
    if (options.charts_number == 0)
        result.l2_stretch = std::sqrt(1.0 + std::max(0.0, excess) / mesh.total_area);
    return result;
}

} // namespace

DevelopableCharts segment_developable_charts(const Mesh& mesh,
                                             const DevelopableChartsOptions& options,
                                             Progress& progress) {
    if (options.charts_number != 0)
        check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    for (const auto& [name, bound] :
         {std::pair("max_linf_stretch", options.max_linf_stretch),
          std::pair("max_chart_l2_stretch", options.max_chart_l2_stretch)})
        if (bound != 0.0 && bound <= 1.0)
            refuse_option(name, "0 for no bound, or a number above 1", bound);
    const mesh::FaceComponents components = mesh::face_components(mesh, [](Index) { return true; });
    DevelopableCharts result = components.count == 1
                                   ? segment_component(mesh, options, progress)
                                   : segment_components(mesh, components, options, progress);
    const Index count = 1 + *std::max_element(result.chart.begin(), result.chart.end());
    result.fitting_error =
        fitting_errors(mesh, result.chart, metrics::fit_conics(mesh, result.chart, count));
    return result;
}

} // namespace devseg::dcharts
