#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/methods/t_flooding/t_flooding.h"

namespace devseg::t_flooding {

using namespace declare;

namespace {

constexpr const char* t_flooding_help =
    "Cuts the surface into a given number of charts that are equally far from developable: all "
    "sweep about the same area on the sphere of normals (the <i>Gauss area</i>, which stands for "
    "Gaussian curvature). Charts flood the surface from seeds, slowly where it is curved; the one "
    "with the least Gauss area is always next. Seeds move to the middle of their charts, and "
    "offsets delay charts that became too large in the round before. Creases and corners count "
    "only inside of charts, so that borders follow them.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut), the same cuts as selected face-edges, the Gauss area as face "
    "quality and a colour for each chart. Every chart is cut to a disk.<br>"
    "See:<br><i>Hitoshi Yamauchi, Stefan Gumhold, Rhaleb Zayer, Hans-Peter Seidel</i><br>"
    "<b>\"Mesh Segmentation Driven by Gaussian Curvature\"</b><br>"
    "The Visual Computer 21, 2005, doi:10.1007/s00371-005-0319-x";

constexpr double all_horns = 1.0; // of cut/tips.h: tips as wide as the chart as well

struct Options : TFloodingOptions {
    bool cut_tips = true;
};

FilterOutput run_t_flooding(const FilterInput& input, const Options& options, Progress& progress) {
    auto segmenting = progress.part(0.96);
    TFloodingResult result = segment_t_flooding(input.mesh, options, segmenting);
    FilterOutput output =
        segmentation_output(input, result.chart, std::move(result.face_gauss_area),
                            {options.cut_tips, {all_horns}}, progress);
    // Charts are numbered anew by their first face: the values follow.
    std::vector<double> gauss_area(result.chart_gauss_area.size());
    for (std::size_t f = 0; f < result.chart.size(); ++f)
        gauss_area[output.charts->chart[f]] = result.chart_gauss_area[result.chart[f]];
    output.values.insert(output.values.end(), {{"chart_gauss_area", std::move(gauss_area)},
                                               {"gauss_area_std", result.gauss_area_std},
                                               {"total_gauss_area", result.total_gauss_area},
                                               {"rounds_number", result.rounds},
                                               {"converged", result.converged}});
    return output;
}

} // namespace

std::vector<FilterDeclaration> filters() {
    using O = Options;
    return {
        Declare<O>("Segmentation: t-flooding", "compute_segmentation_t_flooding_per_face",
                   FilterCategory::remeshing, t_flooding_help)
            .integer(&O::charts_number, "Number of charts",
                     "From 1 to the number of faces. A mesh of more components gets one chart for "
                     "each of them.")
            .real(&O::crease_angle, "Crease angle",
                  "Edges that bend by more than this are creases, degrees, above 0. Smooth edges "
                  "and vertices have no Gauss area of their own.")
            .real(&O::speed_power, "Power of the speed",
                  "Exponent of the curvature in the time that a chart takes to flood a face, "
                  "without unit. Larger values follow features more closely; 0 ignores them.")
            .real(&O::speed_epsilon, "Least curvature",
                  "Added to the curvature, as a share of the largest one on the mesh, above 0. "
                  "Larger values follow features less.")
            .real(
                &O::offset_damping, "Damping of offsets",
                "Share of the imbalance between charts that the next round takes up, without unit, "
                "above 0.")
            .boolean(&O::straighten_boundaries, "straighten_boundaries", "Straighten borders",
                     "Make the borders between charts short while the charts stay balanced.")
            .boolean(&O::cut_tips, "cut_tips", "Cut tips",
                     "Cut charts open up to tips that are at least half as high as the loop around "
                     "them is long: horns, fingers and limbs.")
            .integer(&O::max_iterations, "Most rounds",
                     "The rounds of flooding and reseeding end here at the latest; usually the "
                     "balance stops improving earlier.")
            .integer(&O::random_seed, "Random seed",
                     "0 starts at the face farthest from the centre; other numbers at a random "
                     "face. The same number always gives the same charts.")
            .command("t-flooding")
            .writes(writes_charts | writes_quality | writes_color)
            .result("charts_number", "charts, each a disk")
            .result("cut_length", "length of the cuts inside of charts, model units")
            .result("seam_length", "length of all cut edges, model units")
            .result("chart_gauss_area", "Gauss area of each chart, steradians")
            .result("gauss_area_std", "standard deviation of the charts' Gauss areas, steradians")
            .result("total_gauss_area", "Gauss area of the whole mesh, steradians")
            .result("rounds_number", "rounds of flooding")
            .result("converged", "whether the rounds ended before max_iterations")
            .runs(run_t_flooding)};
}

} // namespace devseg::t_flooding
