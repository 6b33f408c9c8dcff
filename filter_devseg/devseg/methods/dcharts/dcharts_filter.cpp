#include <string>

#include "devseg/atlas/disks.h"
#include "devseg/declare/chart_colors.h"
#include "devseg/declare/declare.h"
#include "devseg/filters/filter_groups.h"
#include "devseg/methods/dcharts/developable_charts.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::dcharts {

namespace {

constexpr const char* dcharts_help =
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

constexpr const char* disks_help =
    "Cuts every chart open until it is a disk, which is what flattening needs: by shortest paths "
    "between its boundary loops, along short cycles through its handles, and by a slit if the "
    "chart is closed. Tips that no flattening maps well, such as those of fingers and horns, are "
    "cut open as well.<br>"
    "Charts are read from the face attribute <b>chart_id</b>; without it from the wedge texture "
    "coordinates, and without those each connected component of the mesh is a chart. The cuts are "
    "added to <b>seam_edges</b>.<br>"
    "See:<br><i>Jeff Erickson, Sariel Har-Peled</i><br>"
    "<b>\"Optimally Cutting a Surface into a Disk\"</b><br>"
    "Discrete &amp; Computational Geometry 31, 2004, doi:10.1007/s00454-003-2948-z<br>"
    "<i>Hitoshi Yamauchi, Stefan Gumhold, Rhaleb Zayer, Hans-Peter Seidel</i><br>"
    "<b>\"Mesh Segmentation Driven by Gaussian Curvature\"</b><br>"
    "The Visual Computer 21, 2005, doi:10.1007/s00371-005-0319-x";

constexpr const char* colorize_help =
    "Gives each chart a colour, so that neighbours differ clearly. The same charts always get the "
    "same colours.<br>"
    "Charts are read from the face attribute <b>chart_id</b>; without it from the wedge texture "
    "coordinates, and without those each connected component of the mesh is a chart.";

declare::FilterOutput run_dcharts(const declare::FilterInput& input,
                                  const DevelopableChartsOptions& options, Progress& progress) {
    DevelopableCharts segmentation = segment_developable_charts(input.mesh, options, progress);
    progress.begin_phase("cutting charts to disks", 0.1);
    const atlas::ChartMap charts =
        atlas::make_chart_map(input.mesh, segmentation.chart, segmentation.seam, false);
    atlas::DiskCuts cuts = atlas::cut_charts_to_disks(input.mesh, charts, progress);
    declare::FilterOutput output;
    output.values = {
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
    output.face_color = declare::face_chart_colors(input.mesh, cuts.charts);
    output.face_quality = std::move(segmentation.fitting_error);
    output.charts = std::move(cuts.charts);
    return output;
}

declare::FilterOutput run_disks(const declare::FilterInput& input,
                                const atlas::DiskOptions& options, Progress& progress) {
    progress.begin_phase("cutting charts to disks", 1.0);
    atlas::DiskCuts cuts =
        atlas::cut_charts_to_disks(input.mesh, filters::find_charts(input), options, progress);
    declare::FilterOutput output;
    output.values = {
        {"charts_number", cuts.charts.count},
        {"cut_charts_number", cuts.cut_charts},
        {"cut_tips_number", cuts.cut_tips},
        {"cut_length", cuts.cut_length * input.mesh.unit_length},
    };
    output.charts = std::move(cuts.charts);
    return output;
}

declare::FilterOutput run_colorize(const declare::FilterInput& input, const declare::NoOptions&,
                                   Progress&) {
    const atlas::ChartMap charts = filters::find_charts(input);
    declare::FilterOutput output;
    output.values = {{"charts_number", charts.count}};
    output.face_color = declare::face_chart_colors(input.mesh, charts);
    return output;
}

declare::FilterDeclaration dcharts() {
    using O = DevelopableChartsOptions;
    return declare::Declare<O>("Segmentation: D-Charts", "compute_segmentation_dcharts_per_face",
                               declare::FilterCategory::remeshing, dcharts_help)
        .integer(&O::charts_number, "charts_number", "Number of charts", 0, 1e9,
                 "The initial estimate of the number of charts, from 1 to the number of faces. "
                 "Large regions that fit no chart get charts of their own, and neighbours that "
                 "flatten well together are joined, so that the final number differs. 0 finds the "
                 "fewest charts whose final map keeps max_l2_stretch and max_linf_stretch.")
        .real(&O::max_fitting_error, "max_fitting_error", "Largest fitting error", 0.0, 4.0,
              "Bound of the fitting error while charts grow, without unit, above 0. Smaller "
              "charts fit better: 0.2 is usual for free forms, 0.01 for mechanical parts.")
        .real(&O::alpha, "alpha", "Weight of developability", 0.0, 10.0,
              "Exponent of the fitting error in the cost of adding a face, without unit.")
        .real(&O::beta, "beta", "Weight of compactness", 0.0, 10.0,
              "Exponent of the roundness of the chart in the cost, without unit. Larger values "
              "avoid long strips.")
        .real(&O::gamma, "gamma", "Weight of straight borders", 0.0, 10.0,
              "Exponent of the ratio of outer to inner edge length in the cost, without unit. "
              "Larger values make smoother borders.")
        .boolean(&O::straighten_boundaries, "straighten_boundaries", "Straighten borders",
                 "Move the borders between charts to where they are short, within the areas that "
                 "fit both charts.")
        .boolean(&O::merge_charts, "merge_charts", "Join charts",
                 "Join neighbouring charts, those with long common borders first, where a trial "
                 "flattening of both as one chart stays within the bounds of merge_threshold.")
        .real(&O::merge_threshold, "merge_threshold", "Joining threshold", 0.0, 1.0,
              "How far joined charts may be from developable, without unit: at most 1 + t / 2 of "
              "L2 stretch and 1 + 4 √t of L∞ stretch. 0.01 suits free forms, 0.00001 mechanical "
              "parts. Darts are cut into charts that exceed the same bounds.")
        .boolean(&O::add_darts, "add_darts", "Cut darts",
                 "Cut from the border of a chart to the spots where its map is stretched most, as "
                 "far as that is worth the length of the cut.")
        .real(&O::max_l2_stretch, "max_l2_stretch", "Largest L2 stretch", 1.0, 100.0,
              "Bound of the L2 stretch of the whole map, above 1, without unit; used where "
              "charts_number is 0, and measured on the final map of the full surface.")
        .real(&O::max_linf_stretch, "max_linf_stretch", "Largest L∞ stretch", 0.0, 1000.0,
              "Bound of the stretch of the worst spot, above 1, without unit; 0 for no bound. Used "
              "where charts_number is 0.")
        .integer(&O::max_iterations, "max_iterations", "Most rounds", 1, 1e6,
                 "The rounds of growing and reseeding end here at the latest; usually fewer than "
                 "5 % of the faces change their chart long before.")
        .integer(&O::random_seed, "random_seed", "Random seed", 0, 2147483647,
                 "0 starts at the face farthest from the centre; other numbers at a random face. "
                 "The same number always gives the same charts.")
        .writes(declare::writes_charts | declare::writes_quality | declare::writes_color)
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
        .runs(run_dcharts);
}

declare::FilterDeclaration disks() {
    return declare::Declare<atlas::DiskOptions>("Charts: Cut to Disks",
                                                "compute_seams_charts_to_disks_per_edge",
                                                declare::FilterCategory::remeshing, disks_help)
        .boolean(&atlas::DiskOptions::cut_tips, "cut_tips", "Cut tips",
                 "Cut charts open up to tips as well: to vertices at least as far from the border "
                 "as the border is long, and to the ends of horns.")
        .writes(declare::writes_charts)
        .result("charts_number", "charts, each a disk")
        .result("cut_charts_number", "charts that were cut")
        .result("cut_tips_number", "cuts up to tips")
        .result("cut_length", "length of the new cuts, model units")
        .runs(run_disks);
}

declare::FilterDeclaration colorize() {
    return declare::Declare<declare::NoOptions>("Charts: Colorize",
                                                "compute_color_by_chart_per_face",
                                                declare::FilterCategory::color, colorize_help)
        .writes(declare::writes_color)
        .result("charts_number", "charts that were coloured")
        .runs(run_colorize);
}

} // namespace

std::vector<declare::FilterDeclaration> segmentation_filters() {
    return {dcharts(), disks(), colorize()};
}

} // namespace devseg::dcharts
