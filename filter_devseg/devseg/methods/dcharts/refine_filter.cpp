// The filter that refines given charts.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/methods/dcharts/refine.h"
#include "devseg/methods/dcharts/standing.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::dcharts {

using namespace declare;

namespace {

constexpr const char* help =
    "Brings charts that there are, whoever made them, within bounds of stretch, without growing new "
    "ones: borders become short within the faces that fit both charts, and charts above a bound get "
    "darts where few are enough, and are split otherwise. Every chart is judged by the map that "
    "'Charts: Flatten' makes.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>; without them "
    "from the wedge texture coordinates, and without those each connected component is a chart. "
    "Every chart is cut to a disk, and coloured; the face quality is the fitting error.<br>"
    "See:<br><i>Dan Julius, Vladislav Kraevoy, Alla Sheffer</i><br>"
    "<b>\"D-Charts: Quasi-Developable Mesh Segmentation\"</b><br>"
    "Computer Graphics Forum (Eurographics), 2005, doi:10.1111/j.1467-8659.2005.00883.x";

FilterOutput run(const FilterInput& input, const RefineOptions& options, Progress& progress) {
    const atlas::ChartMap given = find_charts(input);
    auto refining = progress.part(0.98);
    DevelopableCharts refined = refine_charts(input.mesh, given, options, refining);
    auto cutting = progress.part("cutting charts to disks", 0.02);
    atlas::DiskCuts cuts = atlas::cut_charts_to_disks(
        input.mesh, atlas::make_chart_map(input.mesh, refined.chart, refined.seam, false), cutting);
    const ChartsAbove above = charts_above(cuts.charts, refined.standing);
    ResultValues values = {{"charts_number", cuts.charts.count},
                           {"charts_before_number", given.count},
                           {"joined_charts_number", refined.joins},
                           {"darts_number", refined.darts},
                           {"charts_above_bound_number", above.count},
                           {"rough_charts_number", above.rough},
                           {"roughness_l2", std::sqrt(1.0 + refined.roughness)},
                           {"seam_length", metrics::seam_length(input.mesh, cuts.charts)}};
    FilterOutput output = chart_output(input.mesh, std::move(cuts.charts),
                                       std::move(refined.fitting_error), std::move(values));
    tell(above, refined.roughness, output);
    return output;
}

} // namespace

std::vector<FilterDeclaration> refinement_filters() {
    using O = RefineOptions;
    return {
        Declare<O>("Charts: Refine", "compute_charts_refinement_per_face",
                   FilterCategory::remeshing, help)
            .real(&O::max_chart_l2_stretch, "Largest L2 stretch of a chart",
                  "Bound of the L2 stretch of each chart's final map, above 1, without unit; 0 "
                  "for no bound. Roughness counts apart.")
            .real(&O::max_linf_stretch, "Largest L∞ stretch",
                  "Bound of the stretch of the worst spot, above 1, without unit; 0 for no "
                  "bound.")
            .real(&O::max_l2_stretch, "Largest L2 stretch",
                  "Bound of the L2 stretch of the whole map, above 1, without unit; 0 for no "
                  "bound.")
            .boolean(&O::straighten_boundaries, "straighten_boundaries", "Straighten borders",
                     "Move the borders between charts to where they are short, within the faces "
                     "that fit both charts.")
            .boolean(&O::merge_charts, "merge_charts", "Join charts",
                     "Join neighbours where the joined chart keeps the bounds as well.")
            .boolean(&O::add_darts, "add_darts", "Cut darts",
                     "Cut up to four darts into a chart above its bound, where these are enough. "
                     "Off: it is split.")
            .on_part()
            .keeps()
            .writes(writes_charts | writes_quality | writes_color)
            .result("charts_number", "charts, each a disk")
            .result("charts_before_number", "charts that were given")
            .result("joined_charts_number", "joins of two charts")
            .result("darts_number", "cuts inside charts, to spots of high stretch")
            .result("charts_above_bound_number",
                    "charts above a bound of their own; their faces are selected")
            .result("rough_charts_number",
                    "of these, charts that are above it by no more than the roughness")
            .result("roughness_l2",
                    "L2 stretch of small neighbourhoods, which no segmentation removes")
            .result("seam_length", "length of all cut edges, model units")
            .runs(run)};
}

} // namespace devseg::dcharts
