// The methods that others are compared with.
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/methods/baselines/baselines.h"

namespace devseg::baselines {

using namespace declare;

namespace {

constexpr const char* vsa_help =
    "Cuts the surface into charts that planes approximate best: the integral of the squared "
    "difference between the normals of the surface and of each chart's plane (the metric L2,1) is "
    "lowered by Lloyd rounds, and by teleports, which join two charts that are alike and split the "
    "worst one.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut), the same cuts as selected face-edges, the squared difference "
    "of the normals as face quality and a colour for each chart. Every chart is cut to a disk but for flat holes.<br>"
    "See:<br><i>David Cohen-Steiner, Pierre Alliez, Mathieu Desbrun</i><br>"
    "<b>\"Variational Shape Approximation\"</b><br>"
    "ACM Transactions on Graphics 23(3), 2004, doi:10.1145/1015706.1015817";

constexpr const char* mcgim_help =
    "Cuts the surface into charts that are compact and nearly planar: each face joins the chart "
    "whose seed it reaches by the cheapest path, where a step costs its length and more the "
    "further the normal turns from the chart's; seeds move to the middle of their charts.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut), the same cuts as selected face-edges, the cost of the path "
    "from the seed (model units) as face quality and a colour for each chart. Every chart is cut "
    "to a disk.<br>"
    "See:<br><i>Pedro V. Sander, Zoë J. Wood, Steven J. Gortler, John Snyder, Hugues Hoppe</i><br>"
    "<b>\"Multi-Chart Geometry Images\"</b><br>"
    "Symposium on Geometry Processing, 2003, doi:10.2312/SGP/SGP03/146-155";

template <class O>
Declare<O> baseline(const char* menu_name, const char* python_name, const char* help) {
    Declare<O> filter(menu_name, python_name, FilterCategory::remeshing, help);
    filter
        .integer(&O::charts_number, "Number of charts",
                 "From 1 to the number of faces. A mesh of more components gets one chart for each "
                 "of them.")
        .integer(&O::max_iterations, "Most rounds",
                 "The rounds of growing charts end here at the latest; usually they end before.")
        .integer(&O::random_seed, "Random seed",
                 "0 starts at the face farthest from the centre; other numbers at a random face. "
                 "The same number always gives the same charts.")
        .on_part()
        .keeps()
        .writes(writes_charts | writes_quality | writes_color)
        .result("charts_number", "charts, each a disk but for flat holes")
        .result("cut_length", "length of the cuts inside of charts, model units")
        .result("seam_length", "length of all cut edges, model units")
        .result("rounds_number", "rounds of growing charts")
        .result("converged", "whether the rounds ended before max_iterations");
    return filter;
}

FilterOutput run_vsa(const FilterInput& input, const VsaOptions& options, Progress& progress) {
    auto segmenting = progress.part(0.95);
    VsaResult result = segment_vsa(input.mesh, options, segmenting);
    FilterOutput output = segmentation_output(input, result.chart, std::move(result.face_error),
                                              {false, {}}, progress);
    output.values.insert(
        output.values.end(),
        {{"rounds_number", result.rounds},
         {"converged", result.converged},
         {"teleports_number", result.teleports},
         {"total_error", result.total_error * input.mesh.unit_length * input.mesh.unit_length}});
    return output;
}

FilterOutput run_mcgim(const FilterInput& input, const McgimOptions& options, Progress& progress) {
    auto segmenting = progress.part(0.95);
    McgimResult result = segment_mcgim(input.mesh, options, segmenting);
    for (double& cost : result.face_cost)
        cost *= input.mesh.unit_length;
    FilterOutput output = segmentation_output(input, result.chart, std::move(result.face_cost),
                                              {false, {}}, progress);
    output.values.insert(output.values.end(),
                         {{"rounds_number", result.rounds}, {"converged", result.converged}});
    return output;
}

} // namespace

std::vector<FilterDeclaration> filters() {
    return {baseline<VsaOptions>("Segmentation: Variational Shape Approximation",
                                 "compute_segmentation_variational_shape_approximation_per_face",
                                 vsa_help)
                .boolean(&VsaOptions::teleport_charts, "teleport_charts", "Teleport charts",
                         "Join two charts that are alike and split the worst one where that lowers "
                         "the error.")
                .result("teleports_number", "charts that were moved elsewhere")
                .result("total_error", "integral of the squared difference of the normals, model "
                                       "units squared")
                .command("vsa")
                .runs(run_vsa),
            baseline<McgimOptions>("Segmentation: Multi-Chart Geometry Images",
                                   "compute_segmentation_multi_chart_geometry_images_per_face",
                                   mcgim_help)
                .command("mcgim")
                .runs(run_mcgim)};
}

} // namespace devseg::baselines
