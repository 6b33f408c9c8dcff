#include "devseg/methods/dcharts/developable_charts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/fragments.h"
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/methods/dcharts/full_charts.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/borders.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::dcharts {

using namespace declare;

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

// How the surface at hand is segmented.
struct SegmentationPlan {
    const DevelopableChartsOptions& options;
    bool creased;
    DChartsOptions growing;
};

SegmentationPlan make_plan(const Mesh& mesh, const DevelopableChartsOptions& options) {
    SegmentationPlan plan{options, is_creased(mesh), options};
    if (options.charts_number == 0)
        plan.growing.charts_number = std::min(tuning.automatic_seeds, mesh.face_count());
    if (plan.creased)
        plan.growing.max_fitting_error =
            std::min(options.max_fitting_error, tuning.creased_fitting_error);
    return plan;
}

// D-Charts with short borders.
DChartsResult grow_patches(const Mesh& mesh, const SegmentationPlan& plan, Progress& progress) {
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
    patches.chart = atlas::absorb_fragments(mesh, patches.chart, tuning.least_chart);
    return patches;
}

struct Aim {
    StretchBounds chart;
    double max_excess = infinite;
    bool few = false; // few charts matter more than wide necks between their parts
};

void improve(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim, Draft& draft,
             Progress& progress) {
    if (plan.options.merge_charts) {
        auto joining = progress.part("joining charts", plan.options.add_darts ? 0.75 : 1.0);
        MergeOptions merging;
        merging.chart = aim.chart;
        merging.max_excess = aim.max_excess;
        merging.least_neck = aim.few ? 0.0 : merging.least_neck;
        merge_charts(mesh, merging, draft, joining);
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
    Aim aim;
    aim.chart =
        bounds_from(plan.options.merge_threshold * (plan.creased ? tuning.creased_threshold : 1.0));
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

// With more darts where the worst spot needs them, and measured.
DevelopableCharts finish_within_bounds(const Mesh& mesh,
                                       const std::optional<mesh::CoarseMesh>& decimation,
                                       const SegmentationPlan& plan, const Aim& aim,
                                       const Decided& decided, Straightening straightening,
                                       Progress& progress) {
    const DevelopableChartsOptions& options = plan.options;
    auto finishing = progress.part(0.1);
    DevelopableCharts found = finish(mesh, decimation, plan, decided, straightening, finishing);
    auto measuring = progress.part(0.6);
    measure_stretch(mesh, found, measuring);
    if (options.max_linf_stretch > 0.0 && options.add_darts && distance(options, found) > 1.0 &&
        found.l2_stretch <= options.max_l2_stretch) {
        DartOptions darts;
        darts.chart = {aim.chart.l2, options.max_linf_stretch};
        auto cutting = progress.part("cutting darts", 0.1);
        cut_more_darts(mesh, darts, found, cutting);
        auto again = progress.part(0.1);
        measure_stretch(mesh, found, again);
    }
    return found;
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

// The fewest charts within the bounds: what the coarse surface may use of them is lowered until the
// map of the full surface keeps them.
DevelopableCharts find_fewest(const Mesh& mesh, const std::optional<mesh::CoarseMesh>& decimation,
                              const SegmentationPlan& plan, const DChartsResult& patches,
                              Progress& progress) {
    const DevelopableChartsOptions& options = plan.options;
    const Mesh& coarse = decimation ? decimation->mesh : mesh;
    const double allowed = options.max_l2_stretch * options.max_l2_stretch - 1.0;
    const bool has_linf = options.max_linf_stretch > 0.0;
    double share = tuning.first_share;
    double linf = has_linf ? options.max_linf_stretch
                           : bounds_from(tuning.loose_linf * (options.max_l2_stretch - 1.0)).linf;
    auto trying = progress.part("trying charts", 0.04);
    Decided decided{patches, make_draft(coarse, patches.chart, {}, options.max_l2_stretch, trying)};
    const Draft start = decided.draft;
    DevelopableCharts best;
    const int attempts = has_linf ? tuning.most_linf_attempts : tuning.most_attempts;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        Aim aim;
        aim.chart = {std::sqrt(1.0 + tuning.chart_excess * allowed), linf};
        aim.max_excess = share * allowed * coarse.total_area;
        aim.few = true;
        decided.draft = start;
        auto trial = progress.part(0.5 * progress.left());
        auto splitting = trial.part("splitting charts", 0.04);
        split_worst(coarse, plan, aim, decided.draft, splitting);
        auto improving = trial.part(0.76);
        improve(coarse, plan, aim, decided.draft, improving);
        StretchBounds reached;
        for (const auto straightening : {Straightening::smooth, Straightening::fitting}) {
            auto finishing = trial.part(0.1);
            DevelopableCharts found = finish_within_bounds(mesh, decimation, plan, aim, decided,
                                                           straightening, finishing);
            reached = {found.l2_stretch, found.linf_stretch};
            if (best.chart.empty() || distance(options, found) < distance(options, best))
                best = std::move(found);
            if (distance(options, best) <= 1.0)
                return best;
        }
        share *= std::min(0.9, allowed / (reached.l2 * reached.l2 - 1.0));
        if (has_linf)
            linf = 1.0 + (linf - 1.0) *
                             std::min(0.9, (options.max_linf_stretch - 1.0) / (reached.linf - 1.0));
    }
    if (has_linf && best.l2_stretch <= options.max_l2_stretch)
        split_above(mesh, options.max_linf_stretch, plan.growing, best, progress);
    best.bounds_kept = distance(options, best) <= 1.0;
    return best;
}

} // namespace

OptionRanges<DevelopableChartsOptions> DevelopableChartsOptions::ranges() {
    using O = DevelopableChartsOptions;
    OptionRanges<O> ranges = {{&O::charts_number, {"charts_number", 0, 1e9}},
                              {&O::merge_threshold, {"merge_threshold", 0.0, 1.0, true}},
                              {&O::max_l2_stretch, {"max_l2_stretch", 1.0, 100.0, true}},
                              {&O::max_linf_stretch, {"max_linf_stretch", 0.0, 1000.0}}};
    for (const auto& [field, range] : DChartsOptions::ranges())
        std::visit([&, &r = range](auto f) { ranges.push_back({f, r}); }, field);
    return ranges;
}

DevelopableCharts segment_developable_charts(const Mesh& mesh,
                                             const DevelopableChartsOptions& options,
                                             Progress& progress) {
    if (options.charts_number != 0)
        check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    if (options.max_linf_stretch != 0.0 && options.max_linf_stretch <= 1.0)
        refuse_option("max_linf_stretch", "0 for no bound, or a number above 1",
                      options.max_linf_stretch);
    const SegmentationPlan plan = make_plan(mesh, options);
    auto coarsening = progress.part("coarsening", 0.06);
    const std::optional<mesh::CoarseMesh> decimation = decimate(
        mesh, plan.creased, std::max(options.charts_number, tuning.automatic_seeds), coarsening);
    const Mesh& coarse = decimation ? decimation->mesh : mesh;
    auto growing = progress.part(0.15);
    DChartsResult patches = grow_patches(coarse, plan, growing);
    auto deciding = progress.part(progress.left());
    DevelopableCharts result;
    if (options.charts_number == 0)
        result = find_fewest(mesh, decimation, plan, patches, deciding);
    else
        result = finish(mesh, decimation, plan, decide(coarse, plan, std::move(patches), deciding),
                        Straightening::smooth, deciding);
    const Index count = 1 + *std::max_element(result.chart.begin(), result.chart.end());
    result.fitting_error =
        fitting_errors(mesh, result.chart, metrics::fit_conics(mesh, result.chart, count));
    return result;
}

// The filter
namespace {

constexpr const char* help =
    "Cuts the surface into few charts that are nearly developable, so that they can be flattened "
    "with little distortion: unions of cones, cylinders and planes with a common axis. Charts grow "
    "from seeds while the <i>fitting error</i> (the squared difference between the cosines of the "
    "normal's and the chart's angle to the axis) stays below a bound; seeds and axes are improved "
    "over several rounds. What no chart can reach is filled by the neighbours, or by new charts "
    "where it is large.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut), the same cuts as selected face-edges, the fitting error as "
    "face quality and a colour for each chart. Every chart is cut to a disk.<br>"
    "See:<br><i>Dan Julius, Vladislav Kraevoy, Alla Sheffer</i><br>"
    "<b>\"D-Charts: Quasi-Developable Mesh Segmentation\"</b><br>"
    "Computer Graphics Forum (Eurographics), 2005, doi:10.1111/j.1467-8659.2005.00883.x";

FilterOutput run(const FilterInput& input, const DevelopableChartsOptions& options,
                 Progress& progress) {
    auto segmenting = progress.part(0.98);
    DevelopableCharts segmentation = segment_developable_charts(input.mesh, options, segmenting);
    auto cutting = progress.part("cutting charts to disks", 0.02);
    const atlas::ChartMap charts =
        atlas::make_chart_map(input.mesh, segmentation.chart, segmentation.seam, false);
    atlas::DiskCuts cuts = atlas::cut_charts_to_disks(input.mesh, charts, cutting);
    ResultValues values = {
        {"charts_number", cuts.charts.count},
        {"hole_charts_number", segmentation.hole_charts},
        {"joined_charts_number", segmentation.joins},
        {"darts_number", segmentation.darts},
        {"bounds_kept", segmentation.bounds_kept},
        {"l2_stretch", segmentation.l2_stretch},
        {"linf_stretch", segmentation.linf_stretch},
        {"rounds_number", segmentation.rounds},
        {"converged", segmentation.converged},
        {"seam_length", metrics::seam_length(input.mesh, cuts.charts)},
    };
    return chart_output(input.mesh, std::move(cuts.charts), std::move(segmentation.fitting_error),
                        std::move(values));
}

} // namespace

std::vector<FilterDeclaration> filters() {
    using O = DevelopableChartsOptions;
    return {
        Declare<O>("Segmentation: D-Charts", "compute_segmentation_dcharts_per_face",
                   FilterCategory::remeshing, help)
            .integer(
                &O::charts_number, "Number of charts",
                "The initial estimate of the number of charts, from 1 to the number of faces. "
                "Large regions that fit no chart get charts of their own, and neighbours that "
                "flatten well together are joined, so that the final number differs. 0 finds the "
                "fewest charts whose final map keeps max_l2_stretch and max_linf_stretch.")
            .real(&O::max_fitting_error, "Largest fitting error",
                  "Bound of the fitting error while charts grow, without unit, above 0. Smaller "
                  "charts fit better: 0.2 is usual for free forms, 0.01 for mechanical parts.")
            .real(&O::alpha, "Weight of developability",
                  "Exponent of the fitting error in the cost of adding a face, without unit.")
            .real(&O::beta, "Weight of compactness",
                  "Exponent of the roundness of the chart in the cost, without unit. Larger values "
                  "avoid long strips.")
            .real(&O::gamma, "Weight of straight borders",
                  "Exponent of the ratio of outer to inner edge length in the cost, without unit. "
                  "Larger values make smoother borders.")
            .boolean(
                &O::straighten_boundaries, "straighten_boundaries", "Straighten borders",
                "Move the borders between charts to where they are short, within the areas that "
                "fit both charts.")
            .boolean(
                &O::merge_charts, "merge_charts", "Join charts",
                "Join neighbouring charts, those with long common borders first, where a trial "
                "flattening of both as one chart stays within the bounds of merge_threshold.")
            .real(
                &O::merge_threshold, "Joining threshold",
                "How far joined charts may be from developable, without unit: at most 1 + t / 2 of "
                "L2 stretch and 1 + 4 √t of L∞ stretch. 0.01 suits free forms, 0.00001 mechanical "
                "parts. Darts are cut into charts that exceed the same bounds.")
            .boolean(
                &O::add_darts, "add_darts", "Cut darts",
                "Cut from the border of a chart to the spots where its map is stretched most, as "
                "far as that is worth the length of the cut.")
            .real(&O::max_l2_stretch, "Largest L2 stretch",
                  "Bound of the L2 stretch of the whole map, above 1, without unit; used where "
                  "charts_number is 0, and measured on the final map of the full surface.")
            .real(
                &O::max_linf_stretch, "Largest L∞ stretch",
                "Bound of the stretch of the worst spot, above 1, without unit; 0 for no bound. Used "
                "where charts_number is 0.")
            .integer(
                &O::max_iterations, "Most rounds",
                "The rounds of growing and reseeding end here at the latest; usually fewer than "
                "5 % of the faces change their chart long before.")
            .integer(
                &O::random_seed, "Random seed",
                "0 starts at the face farthest from the centre; other numbers at a random face. "
                "The same number always gives the same charts.")
            .command("dcharts")
            .writes(writes_charts | writes_quality | writes_color)
            .result("charts_number", "charts, each a disk")
            .result("hole_charts_number", "charts that were added where no other fitted")
            .result("joined_charts_number", "joins of two charts")
            .result("darts_number", "cuts inside charts, to spots of high stretch")
            .result("bounds_kept", "with charts_number 0: whether the final map keeps the bounds")
            .result("l2_stretch", "with charts_number 0: L2 stretch of the final map, else 0")
            .result("linf_stretch", "with charts_number 0: L∞ stretch of the final map, else 0")
            .result("rounds_number", "rounds of growing and reseeding")
            .result("converged", "whether fewer than 5 % of the faces changed in the last round")
            .result("seam_length", "length of all cut edges, model units")
            .runs(run)};
}

} // namespace devseg::dcharts
