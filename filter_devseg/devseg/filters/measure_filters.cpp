#include <algorithm>
#include <cmath>

#include "devseg/atlas/disks.h"
#include "devseg/declare/declare.h"
#include "devseg/metrics/circle_maps.h"
#include "devseg/metrics/gauss_area.h"
#include "devseg/metrics/parametrization.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* segmentation_help =
    "Measures a segmentation: how many charts, how long the seams, how developable the charts. "
    "Nothing is changed.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>. Without them "
    "they are read from the wedge texture coordinates, and without those each connected component "
    "of the mesh is a chart. The values are returned to scripts and written to the log.";

constexpr const char* parametrization_help =
    "Measures how well texture coordinates keep the shape of the surface, whoever made them. "
    "Charts are read from the texture coordinates: an edge is a seam where they differ on its two "
    "sides. Each chart is compared at the scale that gives it its area on the surface. Nothing is "
    "changed; the values are returned to scripts and written to the log.<br>"
    "See:<br><i>Pedro V. Sander, John Snyder, Steven J. Gortler, Hugues Hoppe</i><br>"
    "<b>\"Texture Mapping Progressive Meshes\"</b><br>"
    "SIGGRAPH, 2001, doi:10.1145/383259.383307";

constexpr const char* circle_help =
    "Measures how well charts can be flattened at all, without any flattening method. Each chart "
    "is mapped to a disc, its boundary to the circle by length and its inside conformally. The L2 "
    "stretch of that map is taken with the disc scaled to the chart's area.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>. Without them "
    "they are read from the wedge texture coordinates, and without those each connected component "
    "of the mesh is a chart. Those that are no disks are measured as 'Charts: Cut to Disks' opens "
    "them, without cuts to tips.<br>"
    "See:<br><i>Hitoshi Yamauchi, Stefan Gumhold, Rhaleb Zayer, Hans-Peter Seidel</i><br>"
    "<b>\"Mesh Segmentation Driven by Gaussian Curvature\"</b><br>"
    "The Visual Computer 21, 2005, doi:10.1007/s00371-005-0319-x<br>"
    "<i>Mathieu Desbrun, Mark Meyer, Pierre Alliez</i><br>"
    "<b>\"Intrinsic Parameterizations of Surface Meshes\"</b><br>"
    "Computer Graphics Forum 21(3), 2002, doi:10.1111/1467-8659.00580";

FilterOutput run_segmentation(const FilterInput& input, const NoOptions&, Progress& progress) {
    const auto measuring = progress.part("measuring charts", 1.0);
    const metrics::SegmentationMeasures m =
        metrics::measure_segmentation(input.mesh, find_charts(input));
    FilterOutput output;
    output.values = {
        {"charts_number", m.charts_number},
        {"disk_charts_number", m.disk_charts_number},
        {"holed_charts_number", m.holed_charts_number},
        {"gauss_area_std", m.gauss_area_std},
        {"gauss_area_mean", m.gauss_area_mean},
        {"crease_share", m.crease_share},
        {"max_fitting_error", m.max_fitting_error},
        {"seam_length", m.seam_length},
        {"largest_chart_area_share", m.largest_chart_area_share},
    };
    return output;
}

FilterOutput run_parametrization(const FilterInput& input, const NoOptions&, Progress& progress) {
    using Chart = metrics::ChartMeasures;
    using Seam = metrics::SeamMeasures;
    const auto measuring = progress.part("measuring texture coordinates", 1.0);
    const metrics::ParametrizationMeasures m =
        metrics::measure_parametrization(input.mesh, *input.uv);
    FilterOutput output;
    output.values = {
        {"charts_number", m.charts_number},
        {"disk_charts_number", m.disk_charts_number},
        {"holed_charts_number", m.holed_charts_number},
        {"l2_stretch", m.l2_stretch},
        {"linf_stretch", m.linf_stretch},
        {"l2_shear", m.l2_shear},
        {"symmetric_dirichlet_energy", m.symmetric_dirichlet_energy},
        {"max_area_change", m.max_area_change},
        {"strain_99", m.strain.most_of_it},
        {"largest_strain", m.strain.worst},
        {"mean_strain", m.strain.mean},
        {"flipped_faces_number", m.flipped_faces_number},
        {"overlapping_faces_number", m.overlapping_faces_number},
        {"seam_length", m.seam_length},
        {"packing_efficiency", m.packing_efficiency},
        {"chart_area", column(m.charts, &Chart::area)},
        {"chart_l2_stretch", column(m.charts, &Chart::l2_stretch)},
        {"chart_extension", column(m.charts, &Chart::extension)},
        {"chart_compression", column(m.charts, &Chart::compression)},
        {"chart_worst_face", column(m.charts,
                                    [&](const Chart& c) {
                                        return c.worst_face < 0
                                                   ? -1.0
                                                   : double(input.source_face[c.worst_face]);
                                    })},
        {"seam_chart_a", column(m.seams, &Seam::chart_a)},
        {"seam_chart_b", column(m.seams, &Seam::chart_b)},
        {"seam_length_a", column(m.seams, &Seam::length_a)},
        {"seam_length_b", column(m.seams, &Seam::length_b)},
        {"seam_mismatch", column(m.seams, &Seam::mismatch)},
        {"seam_mismatch_percent", column(m.seams, &Seam::mismatch_percent)},
    };
    return output;
}

FilterOutput run_circle_maps(const FilterInput& input, const NoOptions&, Progress& progress) {
    auto cutting = progress.part("cutting charts to disks", 0.1);
    const atlas::DiskCuts cuts = atlas::cut_charts_to_disks(
        input.mesh, find_charts(input), {false, {}, atlas::HoleRule::none()}, cutting);
    auto mapping = progress.part("mapping charts to discs", 0.9);
    std::vector<double> stretch = metrics::circle_map_stretch(input.mesh, cuts.charts, mapping);
    double mean = 0.0;
    double largest = 0.0;
    for (const double s : stretch) {
        mean += s / static_cast<double>(stretch.size());
        largest = std::max(largest, s);
    }
    FilterOutput output;
    output.values = {
        {"charts_number", static_cast<int>(stretch.size())},
        {"circle_l2_stretch", mean},
        {"circle_l2_stretch_std",
         std::isfinite(mean) ? metrics::standard_deviation(stretch) : mean},
        {"largest_circle_l2_stretch", largest},
        {"chart_circle_l2_stretch", std::move(stretch)},
    };
    return output;
}

FilterDeclaration segmentation_measures() {
    return Declare<NoOptions>("Charts: Measure Segmentation", "get_segmentation_measures",
                              FilterCategory::measure, segmentation_help)
        .result("charts_number", "charts")
        .result("disk_charts_number", "charts that are disks once cut along the seams")
        .result("holed_charts_number", "charts that are disks but for holes that lie flat with "
                                       "them: as sound as disks")
        .result("gauss_area_std", "standard deviation of the charts' Gauss areas, steradians")
        .result("gauss_area_mean", "mean of the charts' Gauss areas, steradians")
        .result("crease_share", "share of the length of creases (45 degrees) that is cut, 0 to 1")
        .result("max_fitting_error", "largest squared cosine difference of a face's normal to its "
                                     "chart's best cone, no unit")
        .result("seam_length", "length of all cut edges, each counted once, model units")
        .result("largest_chart_area_share",
                "area of the largest chart over the area of all, 0 to 1")
        .runs(run_segmentation);
}

FilterDeclaration parametrization_measures() {
    return Declare<NoOptions>("Charts: Measure Flattening", "get_parametrization_measures",
                              FilterCategory::measure, parametrization_help)
        .needs_uv()
        .result("charts_number", "charts, as the texture coordinates show them")
        .result("disk_charts_number", "charts that are disks")
        .result("holed_charts_number", "charts that are disks but for holes that lie flat with "
                                       "them: as sound as disks")
        .result("l2_stretch", "root mean square stretch, 1 for an isometry, no unit")
        .result("linf_stretch", "largest stretch in any direction at any face, no unit")
        .result("l2_shear", "root mean square change of the triangles' angles, radians")
        .result("symmetric_dirichlet_energy", "mean of (s1² + s2² + 1/s1² + 1/s2²)/4 over the "
                                              "area, 1 for an isometry, no unit")
        .result("max_area_change", "largest |1 − flat area / area on the surface| of a face")
        .result("strain_99",
                "how much longer or shorter lines get at most on 99 % of the area, with "
                "all charts at one scale, 0.05 = 5 %")
        .result("largest_strain", "the same, of the worst face")
        .result("mean_strain", "the same, the mean over the area")
        .result("flipped_faces_number", "faces turned over against their chart, or flat to a line")
        .result("overlapping_faces_number", "faces that lie on another face in the plane")
        .result("seam_length", "length of all cut edges, each counted once, model units")
        .result("packing_efficiency", "covered share of the layout's bounding box, 0 to 1")
        .result("chart_area", "of each chart: area on the surface, model units squared")
        .result("chart_l2_stretch", "of each chart: root mean square stretch, no unit")
        .result("chart_extension", "of each chart: how much longer a line gets at most when the "
                                   "chart is laid flat, 0.05 = 5 %")
        .result("chart_compression", "of each chart: how much shorter a line gets at most, "
                                     "0.05 = 5 %")
        .result("chart_worst_face", "of each chart: the face with the larger of the two")
        .result("seam_chart_a", "of each pair of pieces that share a seam: the first piece")
        .result("seam_chart_b", "the second piece; the same as the first for darts and slits")
        .result("seam_length_a", "flat length of the seam in the first piece, model units")
        .result("seam_length_b", "flat length of the seam in the second piece, model units")
        .result("seam_mismatch", "first length minus second, model units")
        .result("seam_mismatch_percent", "the same, percent of the mean length")
        .runs(run_parametrization);
}

FilterDeclaration circle_map_measures() {
    return Declare<NoOptions>("Charts: Measure Maps to the Circle", "get_circle_map_measures",
                              FilterCategory::measure, circle_help)
        .result("charts_number", "charts")
        .result("circle_l2_stretch", "mean over the charts, 1 for an isometry")
        .result("circle_l2_stretch_std", "standard deviation over the charts")
        .result("largest_circle_l2_stretch", "of the worst chart")
        .result("chart_circle_l2_stretch", "L2 stretch of each chart")
        .runs(run_circle_maps);
}

} // namespace

std::vector<FilterDeclaration> measure_filters() {
    return {segmentation_measures(), parametrization_measures(), circle_map_measures()};
}

} // namespace devseg::filters
