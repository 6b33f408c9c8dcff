#include "devseg/curves/smooth_seams.h"
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* smooth_help =
    "Makes every seam between charts, every dart and every slit a smooth curve on the surface, free "
    "of the mesh's edges, and splits the faces along it. The surface stays the same: new vertices "
    "lie on old faces, and all attributes of faces and vertices are carried over.<br>"
    "Junctions slide with their seams. Seams on creases and the ends of seams on the mesh's border "
    "stay where they are, and so does a seam that cannot be moved soundly; <b>kept_seams_number</b> "
    "counts them. Charts are read from the face attribute <b>chart_id</b>; without it from the "
    "wedge texture coordinates. Flatten the charts afterwards.<br>"
    "See:<br><i>Stephan Bischoff, Tobias Weyand, Leif Kobbelt</i><br>"
    "<b>\"Snakes on Triangle Meshes\"</b><br>"
    "Bildverarbeitung f&uuml;r die Medizin, 2005, doi:10.1007/3-540-26431-0_43";

FilterOutput run_smooth(const FilterInput& input, const curves::SmoothOptions& options,
                        Progress& progress) {
    const atlas::ChartMap charts = find_charts(input);
    curves::SmoothSeams made = curves::smooth_seams(input.mesh, charts, options, progress);
    FilterOutput output;
    const double unit = input.mesh.unit_length;
    output.values = {
        {"charts_number", made.charts.count},
        {"smooth_seams_number", made.smooth_seams},
        {"kept_seams_number", made.kept_seams},
        {"new_faces_number", made.refinement.mesh.face_count() - input.mesh.face_count()},
        {"seam_length_before", made.old_length * unit},
        {"seam_length", made.new_length * unit},
    };
    output.charts = std::move(made.charts);
    output.refinement = std::move(made.refinement);
    return output;
}

} // namespace

std::vector<FilterDeclaration> smooth_filters() {
    using O = curves::SmoothOptions;
    return {Declare<O>("Charts: Smooth Seams", "meshing_smooth_chart_seams",
                       FilterCategory::remeshing, smooth_help)
                .real(&O::smoothness, "Smoothness",
                      "Length of the waves that go, as a share of the diagonal of the model's box: "
                      "0.01 = 1 %; at least that of the edges on seams.")
                .real(&O::keep_creases, "Keep creases (degrees)",
                      "Seams on edges where the surface bends by more, in degrees, stay where they "
                      "are. 180 = none.")
                .writes(writes_charts | writes_mesh)
                .result("charts_number", "charts, as many as before")
                .result("smooth_seams_number", "seams, darts and slits that are smooth curves now")
                .result("kept_seams_number", "those that stay on their edges")
                .result("new_faces_number", "faces that splitting added")
                .result("seam_length_before", "length of all cut edges before, model units")
                .result("seam_length", "the same afterwards")
                .runs(run_smooth)};
}

} // namespace devseg::filters
