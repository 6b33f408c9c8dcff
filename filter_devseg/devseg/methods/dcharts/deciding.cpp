#include "devseg/methods/dcharts/deciding.h"

#include <algorithm>
#include <cmath>

#include "devseg/atlas/fragments.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/dcharts/bounds.h"
#include "devseg/methods/dcharts/joins.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/borders.h"
#include "devseg/metrics/conic_proxy.h"

namespace devseg::dcharts {

StretchBounds bounds_from(double merge_threshold) {
    return {1.0 + 0.5 * merge_threshold, 1.0 + 4.0 * std::sqrt(merge_threshold)};
}

namespace {

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

} // namespace

bool is_rough(double excess) {
    return excess > tuning.rough;
}

SegmentationPlan make_plan(const Mesh& mesh, const DevelopableChartsOptions& options) {
    SegmentationPlan plan{options, is_creased(mesh), options, {}};
    if (options.charts_number == 0)
        plan.growing.charts_number = std::min(tuning.automatic_seeds, mesh.face_count());
    if (plan.creased)
        plan.growing.max_fitting_error =
            std::min(options.max_fitting_error, tuning.creased_fitting_error);
    return plan;
}

Aim aim_of(const SegmentationPlan& plan) {
    Aim aim;
    aim.chart =
        bounds_from(plan.options.merge_threshold * (plan.creased ? tuning.creased_threshold : 1.0));
    aim.chart.l2 = std::sqrt(aim.chart.l2 * aim.chart.l2 + plan.rough.excess);
    aim.chart.linf += plan.rough.linf - 1.0;
    return aim;
}

namespace {

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

} // namespace

DChartsResult grow_patches(const Mesh& mesh, const SegmentationPlan& plan, Progress& progress) {
    if (plan.creased && plan.options.merge_charts) {
        auto looking = progress.part(0.5);
        if (auto patches = patches_between_creases(mesh, plan, looking))
            return *std::move(patches);
    }
    auto growing = progress.part(progress.left());
    return grow_charts(mesh, plan, growing);
}

namespace {

MergeOptions merge_options(const SegmentationPlan& plan, const Aim& aim) {
    const DevelopableChartsOptions& options = plan.options;
    MergeOptions merging;
    merging.parts_above = plan.creased ? 0 : options.charts_number;
    merging.keep_corners = plan.creased;
    merging.exchange_cuts = aim.few && !plan.creased;
    merging.coarse_trials = !aim.few;
    merging.chart = aim.chart;
    if (options.max_chart_l2_stretch > 0.0) {
        merging.chart.hard_l2 = std::sqrt(
            options.max_chart_l2_stretch * options.max_chart_l2_stretch + plan.rough.excess);
        merging.chart.l2 = std::min(merging.chart.l2, merging.chart.hard_l2);
    }
    FinalBounds bounds;
    bounds.strain = options.max_strain;
    bounds.roughness = plan.rough.excess;
    merging.chart.strain = bounds.allowed_strain(tuning.certain);
    merging.max_excess = aim.max_excess;
    if (aim.few || plan.creased)
        merging.least_neck = aim.few ? 0.0 : tuning.creased_neck;
    return merging;
}

// Of each chart, whether it lies on a component that is no polyhedron: charts do not unfold exactly
// there.
std::vector<std::uint8_t> charts_off_polyhedra(const Mesh& mesh, const Draft& draft) {
    const mesh::FaceComponents components =
        mesh::face_components(mesh, [](HalfEdge) { return true; });
    std::vector<double> excess(at(components.count), 0.0);
    std::vector<double> area(at(components.count), 0.0);
    for (std::size_t p = 0; p < draft.faces.size(); ++p) {
        if (draft.faces[p].empty())
            continue;
        const auto c = at(components.label[at(draft.faces[p].front())]);
        area[c] += draft.map[p].area;
        excess[c] += draft.map[p].area * (draft.map[p].l2_squared - 1.0);
    }
    std::vector<std::uint8_t> off(draft.faces.size(), 0);
    for (std::size_t p = 0; p < draft.faces.size(); ++p)
        if (!draft.faces[p].empty()) {
            const auto c = at(components.label[at(draft.faces[p].front())]);
            off[p] = !(excess[c] < tuning.negligible * area[c]);
        }
    return off;
}

// Joins of a creased surface that are not exact, as those of smooth ones: while there are more
// charts than wanted, or for the fewest. Nets of polyhedra stay exact, whatever lies beside them.
void join_as_smooth(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim, Draft& draft,
                    Progress& progress) {
    const bool to_number = plan.options.charts_number > 0;
    SegmentationPlan as_smooth = plan;
    as_smooth.creased = false;
    MergeOptions merging = merge_options(as_smooth, to_number ? aim_of(as_smooth) : aim);
    merging.enough_charts = plan.options.charts_number;
    merging.open = charts_off_polyhedra(mesh, draft);
    merge_charts(mesh, merging, draft, progress);
}

void darts_into(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim, Draft& draft,
                Progress& progress) {
    if (!plan.options.add_darts)
        return;
    DartOptions darts;
    darts.chart = aim.chart;
    cut_darts(mesh, darts, draft, progress);
}

} // namespace

std::vector<Draft> improve(const Mesh& mesh, const SegmentationPlan& plan, Aim aim,
                           const std::vector<double>& max_excess, Draft draft, Progress& progress) {
    std::vector<Draft> drafts;
    if (plan.options.merge_charts && !plan.creased) {
        auto joining = progress.part("joining charts", plan.options.add_darts ? 0.75 : 1.0);
        drafts = merge_charts_in_steps(mesh, merge_options(plan, aim), max_excess, std::move(draft),
                                       joining);
        auto cutting = progress.part("cutting darts", 1.0);
        for (Draft& step : drafts)
            darts_into(mesh, plan, aim, step, cutting);
        return drafts;
    }
    // Exact joins come first again in each step.
    for (const double most : max_excess) {
        aim.max_excess = most;
        if (plan.options.merge_charts) {
            auto joining = progress.part("joining charts", 0.4 * progress.left());
            merge_charts(mesh, merge_options(plan, aim), draft, joining);
            join_as_smooth(mesh, plan, aim, draft, joining);
        }
        auto cutting = progress.part("cutting darts", 0.2 * progress.left());
        darts_into(mesh, plan, aim, draft, cutting);
        drafts.push_back(draft);
    }
    return drafts;
}

namespace {

Decided join_patches(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim,
                     DChartsResult patches, Progress& progress) {
    auto trying = progress.part("trying charts", 0.07);
    Draft draft = make_draft(mesh, patches.chart, {}, aim.chart.l2, trying);
    auto improving = progress.part(0.93);
    std::vector<Draft> drafts =
        improve(mesh, plan, aim, {aim.max_excess}, std::move(draft), improving);
    return {std::move(patches), std::move(drafts.front())};
}

} // namespace

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
    if (patches.chart == few.patches.chart) // between creases, whatever the number of seeds
        return few;
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

bool keep_final_bounds(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim, bool may_cut,
                       DevelopableCharts& charts, Progress& progress) {
    const DevelopableChartsOptions& options = plan.options;
    FinalBounds bounds;
    bounds.chart_l2 = options.max_chart_l2_stretch;
    bounds.strain = options.max_strain;
    bounds.roughness = is_rough(charts.roughness) ? charts.roughness : 0.0;
    charts.standing.assign(mesh.faces.size(), Standing::kept);
    if (options.charts_number == 0) {
        bounds.linf = options.max_linf_stretch;
        bounds.max_excess =
            (options.max_l2_stretch * options.max_l2_stretch - 1.0) * mesh.total_area;
    }
    if (bounds.chart_l2 == 0.0 && bounds.strain == 0.0 && options.charts_number != 0)
        return true;
    MergeOptions merging = merge_options(plan, aim);
    merging.max_excess = bounds.max_excess;
    merging.confirm = options.merge_charts;
    // Parts of borders are many, and a trial on a large surface is slow.
    if (mesh.face_count() > tuning.decimated_faces)
        merging.parts_above = mesh.face_count();
    bounds.add_darts = options.add_darts;
    bounds.may_cut = may_cut;
    return keep_bounds(mesh, bounds, plan.growing, merging, charts, progress);
}

} // namespace devseg::dcharts
