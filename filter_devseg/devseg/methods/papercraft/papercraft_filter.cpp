#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/methods/papercraft/papercraft.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::papercraft {

using namespace declare;

namespace {

constexpr const char* papercraft_help =
    "Cuts the surface into few charts that paper can take on with <i>creases</i> and <i>slits</i>. "
    "Charts grow by vertices: a vertex may come inside of a chart if the angles around it sum up to "
    "nearly 360 degrees, whatever creases run through it. Where a chart meets itself a slit stays "
    "open, and ends at vertices that are far from developable. The smallest charts are removed and "
    "the others grown again until the wanted number is left, and slits that matter little are "
    "closed.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut, slits included), the same cuts as selected face-edges, the "
    "face's share of the angle defects of its vertices (radians) as face quality and a colour for "
    "each chart. Every chart is a disk. Go on with 'Charts: Deform to Exact Developability'.<br>"
    "See:<br><i>Kuniko Takahashi, Tomohiro Tachi, Yasushi Yamaguchi</i><br>"
    "<b>\"Mesh Approximation for Generating Development with Creases and Slits\"</b><br>"
    "Journal for Geometry and Graphics 19(1), 2015, pages 119-129";

FilterOutput run_papercraft(const FilterInput& input, const PapercraftOptions& options,
                            Progress& progress) {
    PapercraftResult result = segment_papercraft(input.mesh, options, progress);
    ResultValues values = {
        {"charts_number", result.charts.count},
        {"initial_charts_number", result.initial_charts},
        {"rounds_number", result.rounds},
        {"closed_edges_number", result.closed_edges},
        {"slit_length", result.slit_length * input.mesh.unit_length},
        {"seam_length", metrics::seam_length(input.mesh, result.charts)},
    };
    return chart_output(input.mesh, std::move(result.charts), std::move(result.defect_share),
                        std::move(values));
}

} // namespace

std::vector<FilterDeclaration> filters() {
    using O = PapercraftOptions;
    return {
        Declare<O>("Segmentation: Papercraft with Creases and Slits",
                   "compute_segmentation_papercraft_per_face", FilterCategory::remeshing,
                   papercraft_help)
            .integer(&O::charts_number, "Number of charts",
                     "From 1 to the number of faces. Fewer charts have more and longer slits. A "
                     "mesh of more components gets one chart for each of them.")
            .real(&O::growth_threshold, "Growth threshold",
                  "What the inner vertices of a chart of the initial segmentation may lack to "
                  "360 degrees, or have too much, all together, in radians, above 0. Smaller "
                  "values start from more and smaller charts; halved where there are fewer "
                  "than wanted.")
            .real(&O::slit_threshold, "Slit threshold",
                  "Slits are closed where the paper has to bridge a gap of about this width, "
                  "as a share of the diagonal of the model's box. 0 closes none.")
            .integer(&O::max_iterations, "Most rounds",
                     "Rounds in which the smallest charts are removed and the others grown "
                     "again; the last one removes all that are too many.")
            .integer(&O::random_seed, "Random seed",
                     "0 takes angles as they are; other numbers vary them a little, for other "
                     "charts. The same number always gives the same charts.")
            .command("papercraft", "symmetric-dirichlet", "papercraft", true)
            .writes(writes_charts | writes_quality | writes_color)
            .result("charts_number", "charts, each a disk")
            .result("initial_charts_number", "charts of the initial segmentation")
            .result("rounds_number", "rounds of removing charts and growing the others")
            .result("closed_edges_number", "edges of slits that were closed")
            .result("slit_length", "length of the slits that are left, model units")
            .result("seam_length", "length of all cut edges, model units")
            .runs(run_papercraft)};
}

} // namespace devseg::papercraft
