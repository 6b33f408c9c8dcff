// The filter of D-Charts.
#include <algorithm>
#include <cmath>

#include "devseg/atlas/disks.h"
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/material/material.h"
#include "devseg/methods/dcharts/developable_charts.h"
#include "devseg/methods/dcharts/standing.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::dcharts {

using namespace declare;

OptionRanges<DevelopableChartsOptions> DevelopableChartsOptions::ranges() {
    using O = DevelopableChartsOptions;
    OptionRanges<O> ranges = {{&O::charts_number, {"charts_number", 0, 1e9}},
                              {&O::merge_threshold, {"merge_threshold", 0.0, 1.0, true}},
                              {&O::max_l2_stretch, {"max_l2_stretch", 1.0, 100.0, true}},
                              {&O::max_linf_stretch, {"max_linf_stretch", 0.0, 1000.0}},
                              {&O::max_chart_l2_stretch, {"max_chart_l2_stretch", 0.0, 100.0}},
                              {&O::max_strain, {"max_strain", 0.0, 10.0}}};
    for (const auto& [field, range] : DChartsOptions::ranges())
        std::visit([&, &r = range](auto f) { ranges.push_back({f, r}); }, field);
    return ranges;
}

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
    "face quality and a colour for each chart. Every chart is cut to a disk but for flat holes.<br>"
    "See:<br><i>Dan Julius, Vladislav Kraevoy, Alla Sheffer</i><br>"
    "<b>\"D-Charts: Quasi-Developable Mesh Segmentation\"</b><br>"
    "Computer Graphics Forum (Eurographics), 2005, doi:10.1111/j.1467-8659.2005.00883.x";

struct Options : DevelopableChartsOptions {
    std::string material; // that sets max_strain where nobody else does
};

FilterOutput run(const FilterInput& input, const Options& given, Progress& progress) {
    Options options = given;
    if (!options.material.empty()) {
        const material::Material material = material::read_material(options.material);
        if (options.max_strain == 0.0)
            options.max_strain = material.search_bound();
    }
    auto segmenting = progress.part(0.98);
    DevelopableCharts segmentation = segment_developable_charts(input.mesh, options, segmenting);
    auto cutting = progress.part("cutting charts to disks", 0.02);
    const atlas::ChartMap charts =
        atlas::make_chart_map(input.mesh, segmentation.chart, segmentation.seam, false);
    atlas::DiskCuts cuts = atlas::cut_charts_to_disks(input.mesh, charts, cutting);
    const ChartsAbove above = charts_above(cuts.charts, segmentation.standing);
    ResultValues values = {
        {"charts_number", cuts.charts.count},
        {"hole_charts_number", segmentation.hole_charts},
        {"joined_charts_number", segmentation.joins},
        {"darts_number", segmentation.darts},
        {"bounds_kept", segmentation.bounds_kept && !above.any()},
        {"charts_above_bound_number", above.count},
        {"rough_charts_number", above.rough},
        {"roughness_l2", std::sqrt(1.0 + segmentation.roughness)},
        {"l2_stretch", segmentation.l2_stretch},
        {"linf_stretch", segmentation.linf_stretch},
        {"largest_strain", segmentation.strain.worst},
        {"strain_99", segmentation.strain.most_of_it},
        {"rounds_number", segmentation.rounds},
        {"converged", segmentation.converged},
        {"seam_length", metrics::seam_length(input.mesh, cuts.charts)},
    };
    FilterOutput output = chart_output(input.mesh, std::move(cuts.charts),
                                       std::move(segmentation.fitting_error), std::move(values));
    tell(above, segmentation.roughness, output);
    return output;
}

} // namespace

std::vector<FilterDeclaration> filters() {
    using O = Options;
    return {
        Declare<O>("Segmentation: D-Charts", "compute_segmentation_dcharts_per_face",
                   FilterCategory::remeshing, help)
            .integer(
                &O::charts_number, "Number of charts",
                "The aim for the number of charts of the whole mesh, from 1 to the number of faces. "
                "Components get charts by need, large regions that fit no chart get charts of their "
                "own, and neighbours that flatten well together are joined, so that the final number "
                "differs. 0 finds the fewest charts whose final map keeps max_l2_stretch and "
                "max_linf_stretch.")
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
            .real(&O::max_chart_l2_stretch, "Largest L2 stretch of a chart",
                  "Bound of the L2 stretch of each chart's final map, above 1, without unit; 0 for "
                  "no bound, as in the paper. Charts above it get darts or are split, whatever the "
                  "number of charts. Roughness counts apart.")
            .real(&O::max_strain, "Largest strain",
                  "How much longer or shorter lines in the material may get in the final map of a "
                  "chart, as a share: 0.1 = 10 % on 99 % of its area, and at most twice that "
                  "anywhere. 0 for no bound. Charts above it get darts or are split. Roughness "
                  "counts apart. The final map is that of LPFB then, which keeps both sides of "
                  "seams equally long: flatten with it.")
            .text(&O::material, "material", "Material",
                  "What the pieces are cut from: " + material::names() +
                      ", also with values of its own as in fleece, warp=0.12. Where max_strain is "
                      "0, it is the least of the material's limits.")
            .integer(
                &O::max_iterations, "Most rounds",
                "The rounds of growing and reseeding end here at the latest; usually fewer than "
                "5 % of the faces change their chart long before.")
            .integer(
                &O::random_seed, "Random seed",
                "0 starts at the face farthest from the centre; other numbers at a random face. "
                "The same number always gives the same charts.")
            .command("dcharts")
            .on_part()
            .keeps()
            .writes(writes_charts | writes_quality | writes_color)
            .result("charts_number", "charts, each a disk but for flat holes")
            .result("hole_charts_number", "charts that were added where no other fitted")
            .result("joined_charts_number", "joins of two charts")
            .result("darts_number", "cuts inside charts, to spots of high stretch")
            .result("bounds_kept", "whether the final map keeps all bounds")
            .result("charts_above_bound_number",
                    "charts above a bound of their own; their faces are selected")
            .result("rough_charts_number",
                    "of these, charts that are above it by no more than the roughness")
            .result("roughness_l2",
                    "L2 stretch of small neighbourhoods, which no segmentation removes")
            .result("l2_stretch", "with charts_number 0: L2 stretch of the final map, else 0")
            .result("linf_stretch", "with charts_number 0: L∞ stretch of the final map, else 0")
            .result("largest_strain", "with a bound of strain: the largest of a face, else 0")
            .result("strain_99",
                    "with a bound of strain: what 99 % of the area of each chart keeps, else 0")
            .result("rounds_number", "rounds of growing and reseeding")
            .result("converged", "whether fewer than 5 % of the faces changed in the last round")
            .result("seam_length", "length of all cut edges, model units")
            .runs(run)};
}

} // namespace devseg::dcharts
