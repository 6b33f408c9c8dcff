#include "devseg/methods/dcharts/developable_charts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "devseg/atlas/fragments.h"
#include "devseg/judge/roughness.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/dcharts/bounds.h"
#include "devseg/methods/dcharts/full_charts.h"
#include "devseg/methods/dcharts/joins.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/borders.h"
#include "devseg/metrics/conic_proxy.h"

namespace devseg::dcharts {

namespace {

// Stretch that joined charts may have, from η: at η = 0.01, L2 1.005 and L∞ 1.4.
StretchBounds bounds_from(double merge_threshold) {
    return {1.0 + 0.5 * merge_threshold, 1.0 + 4.0 * std::sqrt(merge_threshold)};
}

// Whether creases, rather than smooth or rough regions, give the surface its shape: then most edges
// that are not smooth are sharp, and they are longer than the surface is wide.
bool is_creased(const Mesh& mesh) {
    double bent = 0.0;
    double sharp = 0.0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin <= h)
            continue;
        const double cosine = mesh.face_normals[face_of(h)].dot(mesh.face_normals[face_of(twin)]);
        bent += cosine < tuning.bent_cosine ? mesh.edge_length(h) : 0.0;
        sharp += cosine < tuning.sharp_edge_cosine ? mesh.edge_length(h) : 0.0;
    }
    return sharp > std::sqrt(mesh.total_area) && sharp > tuning.sharp_share * bent;
}

bool is_rough(double excess) {
    return excess > tuning.rough;
}

// How the surface at hand is segmented.
struct SegmentationPlan {
    const DevelopableChartsOptions& options;
    bool creased;
    DChartsOptions growing;
    judge::Roughness rough; // of the surface on which is decided, where it is rough
};

SegmentationPlan make_plan(const Mesh& mesh, const DevelopableChartsOptions& options) {
    SegmentationPlan plan{options, is_creased(mesh), options, {}};
    if (options.charts_number == 0)
        plan.growing.charts_number = std::min(tuning.automatic_seeds, mesh.face_count());
    if (plan.creased)
        plan.growing.max_fitting_error =
            std::min(options.max_fitting_error, tuning.creased_fitting_error);
    return plan;
}

struct Aim {
    StretchBounds chart;
    double max_excess = infinite;
    bool few = false; // few charts matter more than wide necks between their parts
};

// Of a given number of charts.
Aim aim_of(const SegmentationPlan& plan) {
    Aim aim;
    aim.chart =
        bounds_from(plan.options.merge_threshold * (plan.creased ? tuning.creased_threshold : 1.0));
    aim.chart.l2 = std::sqrt(aim.chart.l2 * aim.chart.l2 + plan.rough.excess);
    aim.chart.linf += plan.rough.linf - 1.0;
    return aim;
}

// D-Charts with short borders.
DChartsResult grow_charts(const Mesh& mesh, const SegmentationPlan& plan, Progress& progress) {
    auto growing = progress.part(0.15);
    DChartsResult patches = segment_dcharts(mesh, plan.growing, growing);
    auto straightening = progress.part("straightening borders", 0.85);
    if (plan.options.straighten_boundaries) {
        growth::ExpansionOptions expansion;
        expansion.max_fitting_error = plan.growing.max_fitting_error;
        expansion.length_weight =
            plan.creased ? tuning.creased_length_weight : tuning.smooth_length_weight;
        growth::relabel_by_expansion(mesh, patches.proxies, expansion, patches.chart,
                                     straightening);
    }
    mesh::keep_regions_whole(mesh, tuning.least_chart, patches.chart);
    patches.chart = atlas::absorb_fragments(mesh, patches.chart, tuning.least_chart);
    return patches;
}

// The parts of a surface between its creases. Where one is far from developable, D-Charts grow in
// it, or its flat faces stand for themselves if they are few.
std::optional<DChartsResult> patches_between_creases(const Mesh& mesh, const SegmentationPlan& plan,
                                                     Progress& progress) {
    const mesh::FaceComponents smooth = mesh::face_components(mesh, [&](HalfEdge h) {
        return mesh.face_normals[face_of(h)].dot(mesh.face_normals[mesh.across(h)]) >=
               tuning.bent_cosine;
    });
    if (smooth.count > tuning.most_regions)
        return {};
    const StretchBounds bounds = aim_of(plan).chart;
    auto trying = progress.part("trying charts", 0.3);
    const Draft draft = make_draft(mesh, smooth.label, {}, bounds.l2, trying);
    DChartsResult patches;
    patches.chart = smooth.label;
    patches.converged = true;
    Index count = smooth.count;
    for (Index p = 0; p < smooth.count; ++p) {
        if (draft.map[p].flat && bounds.hold(draft.map[p]))
            continue;
        const Mesh part = mesh_of_chart(mesh, draft.faces[p]);
        mesh::FaceComponents inside = mesh::flat_regions(part);
        if (inside.count > tuning.few_regions) {
            SegmentationPlan own = plan;
            own.growing.charts_number =
                std::clamp(static_cast<int>(std::lround(plan.growing.charts_number *
                                                        part.total_area / mesh.total_area)),
                           1, part.face_count());
            auto growing = progress.part(0.5 * progress.left());
            DChartsResult grown = grow_charts(part, own, growing);
            inside.label = std::move(grown.chart);
            inside.count = 1 + *std::max_element(inside.label.begin(), inside.label.end());
            patches.hole_charts += grown.hole_charts;
        }
        for (const Face f : part.all_faces())
            if (inside.label[f] > 0)
                patches.chart[draft.faces[p][f]] = count + inside.label[f] - 1;
        count += inside.count - 1;
    }
    patches.proxies = metrics::fit_conics(mesh, patches.chart, count);
    return patches;
}

DChartsResult grow_patches(const Mesh& mesh, const SegmentationPlan& plan, Progress& progress) {
    if (plan.creased && plan.options.merge_charts) {
        auto looking = progress.part(0.5);
        if (auto patches = patches_between_creases(mesh, plan, looking))
            return *std::move(patches);
    }
    auto growing = progress.part(progress.left());
    return grow_charts(mesh, plan, growing);
}

MergeOptions merge_options(const SegmentationPlan& plan, const Aim& aim) {
    const DevelopableChartsOptions& options = plan.options;
    MergeOptions merging;
    merging.parts_above = plan.creased ? 0 : options.charts_number;
    merging.keep_corners = plan.creased;
    merging.chart = aim.chart;
    if (options.max_chart_l2_stretch > 0.0) {
        merging.chart.hard_l2 = std::sqrt(
            options.max_chart_l2_stretch * options.max_chart_l2_stretch + plan.rough.excess);
        merging.chart.l2 = std::min(merging.chart.l2, merging.chart.hard_l2);
    }
    merging.max_excess = aim.max_excess;
    if (aim.few || plan.creased)
        merging.least_neck = aim.few ? 0.0 : tuning.creased_neck;
    return merging;
}

// Joins that are not exact, as those of smooth surfaces, while there are more charts than wanted.
void join_to_number(const Mesh& mesh, const SegmentationPlan& plan, Draft& draft,
                    Progress& progress) {
    SegmentationPlan as_smooth = plan;
    as_smooth.creased = false;
    MergeOptions merging = merge_options(as_smooth, aim_of(as_smooth));
    merging.enough_charts = plan.options.charts_number;
    merge_charts(mesh, merging, draft, progress);
}

void improve(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim, Draft& draft,
             Progress& progress) {
    if (plan.options.merge_charts) {
        auto joining = progress.part("joining charts", plan.options.add_darts ? 0.75 : 1.0);
        auto first = joining.part(0.7);
        merge_charts(mesh, merge_options(plan, aim), draft, first);
        if (plan.creased && plan.options.charts_number > 0)
            join_to_number(mesh, plan, draft, joining);
    }
    if (plan.options.add_darts) {
        auto cutting = progress.part("cutting darts", 1.0);
        DartOptions darts;
        darts.chart = aim.chart;
        cut_darts(mesh, darts, draft, cutting);
    }
}

// What is decided on the decimated surface.
struct Decided {
    DChartsResult patches; // before joining
    Draft draft;
};

Decided join_patches(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim,
                     DChartsResult patches, Progress& progress) {
    auto trying = progress.part("trying charts", 0.07);
    Draft draft = make_draft(mesh, patches.chart, {}, aim.chart.l2, trying);
    auto improving = progress.part(0.93);
    improve(mesh, plan, aim, draft, improving);
    return {std::move(patches), std::move(draft)};
}

Decided decide(const Mesh& mesh, const SegmentationPlan& plan, DChartsResult patches,
               Progress& progress) {
    if (!plan.options.merge_charts && !plan.options.add_darts) {
        Draft draft = make_untried_draft(mesh, patches.chart);
        return {std::move(patches), std::move(draft)};
    }
    const Aim aim = aim_of(plan);
    const bool is_few = plan.options.merge_charts && plan.options.charts_number <= tuning.few_seeds;
    auto trying = progress.part(is_few ? 0.5 : 0.95);
    Decided few = join_patches(mesh, plan, aim, std::move(patches), trying);
    if (!is_few || few.draft.charts_number() <= plan.options.charts_number)
        return few;
    // What few seeds do not reach becomes charts of its own, of any shape: charts of more seeds may
    // be joined to fewer.
    SegmentationPlan with_more = plan;
    with_more.growing.charts_number = std::min(2 * tuning.few_seeds, mesh.face_count());
    auto growing = progress.part(0.2 * progress.left());
    patches = grow_patches(mesh, with_more, growing);
    auto again = progress.part(0.9 * progress.left());
    Decided more = join_patches(mesh, with_more, aim, std::move(patches), again);
    if (more.draft.charts_number() < few.draft.charts_number())
        return more;
    return few;
}

DevelopableCharts finish(const Mesh& mesh, const std::optional<mesh::CoarseMesh>& decimation,
                         const SegmentationPlan& plan, const Decided& decided,
                         Straightening straightening, Progress& progress) {
    auto finishing = progress.part("finishing borders", 1.0);
    if (!plan.options.straighten_boundaries)
        straightening = Straightening::none;
    else if (!plan.options.merge_charts || // the bound is F_max then, and not a stretch
             plan.creased)                 // borders stay on the creases
        straightening = Straightening::fitting;
    const DChartsResult& patches = decided.patches;
    DevelopableCharts result = transfer(mesh, decimation, decided.draft, patches.chart,
                                        plan.growing.max_fitting_error, straightening, finishing);
    result.rounds = patches.rounds;
    result.converged = patches.converged;
    result.hole_charts = patches.hole_charts;
    result.joins = decided.draft.joins;
    finishing.check();
    return result;
}

// From isometry, in bounds: at most 1 where they are kept.
double distance(const DevelopableChartsOptions& options, const DevelopableCharts& charts) {
    const auto excess = [](double stretch) { return stretch * stretch - 1.0; };
    const double l2 = excess(charts.l2_stretch) / excess(options.max_l2_stretch);
    return options.max_linf_stretch == 0.0
               ? l2
               : std::max(l2, excess(charts.linf_stretch) / excess(options.max_linf_stretch));
}

// What the final map keeps.
void keep_final_bounds(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim,
                       DevelopableCharts& charts, Progress& progress) {
    const DevelopableChartsOptions& options = plan.options;
    FinalBounds bounds;
    bounds.chart_l2 = options.max_chart_l2_stretch;
    bounds.roughness = is_rough(charts.roughness) ? charts.roughness : 0.0;
    charts.above.assign(mesh.faces.size(), 0);
    if (options.charts_number == 0) {
        bounds.linf = options.max_linf_stretch;
        bounds.max_excess =
            (options.max_l2_stretch * options.max_l2_stretch - 1.0) * mesh.total_area;
    }
    if (bounds.chart_l2 == 0.0 && options.charts_number != 0)
        return;
    MergeOptions merging = merge_options(plan, aim);
    merging.max_excess = bounds.max_excess;
    merging.confirm = options.merge_charts;
    // Parts of borders are many, and a trial on a large surface is slow.
    if (mesh.face_count() > tuning.decimated_faces)
        merging.parts_above = mesh.face_count();
    bounds.add_darts = options.add_darts;
    keep_bounds(mesh, bounds, plan.growing, merging, charts, progress);
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

// The fewest charts within the bounds: found on the coarse surface, then cut where the map of the
// full one does not keep them.
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
    aim.max_excess = tuning.first_share * allowed * coarse.total_area;
    auto trying = progress.part("trying charts", 0.04);
    Decided decided{patches, make_draft(coarse, patches.chart, {}, options.max_l2_stretch, trying)};
    auto splitting = progress.part("splitting charts", 0.04);
    split_worst(coarse, plan, aim, decided.draft, splitting);
    auto improving = progress.part(0.5);
    improve(coarse, plan, aim, decided.draft, improving);
    auto finishing = progress.part(0.1);
    DevelopableCharts found =
        finish(mesh, decimation, plan, decided, Straightening::smooth, finishing);
    found.roughness = roughness;
    auto keeping = progress.part(progress.left());
    keep_final_bounds(mesh, plan, aim, found, keeping);
    found.bounds_kept = distance(options, found) <= 1.0;
    return found;
}

// A surface in one piece.
DevelopableCharts segment_component(const Mesh& mesh, const DevelopableChartsOptions& options,
                                    Progress& progress) {
    if (mesh::flat_regions(mesh).count == 1) {
        DevelopableCharts sheet;
        sheet.chart.assign(mesh.faces.size(), 0);
        sheet.seam.assign(mesh.twin.size(), 0);
        sheet.above.assign(mesh.faces.size(), 0);
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
    keep_final_bounds(mesh, plan, aim_of(plan), result, keeping);
    return result;
}

void add_up(const DevelopableCharts& part, DevelopableCharts& whole) {
    whole.rounds = std::max(whole.rounds, part.rounds);
    whole.converged = whole.converged && part.converged;
    whole.hole_charts += part.hole_charts;
    whole.joins += part.joins;
    whole.darts += part.darts;
    whole.linf_stretch = std::max(whole.linf_stretch, part.linf_stretch);
    whole.bounds_kept = whole.bounds_kept && part.bounds_kept;
}

// The parts of a surface, one after the other, each with its share of the charts.
DevelopableCharts segment_components(const Mesh& mesh, const mesh::FaceComponents& components,
                                     const DevelopableChartsOptions& options, Progress& progress) {
    DevelopableCharts result;
    result.converged = true;
    result.chart.resize(mesh.faces.size());
    result.seam.assign(mesh.twin.size(), 0);
    result.above.assign(mesh.faces.size(), 0);
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
            result.above[faces[f]] = charts.above[f];
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
