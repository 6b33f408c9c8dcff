#include "devseg/filters/chart_colors.h"
#include "devseg/filters/declare.h"
#include "devseg/filters/filter_groups.h"
#include "devseg/metrics/segmentation.h"
#include "devseg/plush/plush_seams.h"

namespace devseg {

namespace {

constexpr const char* plush_help = "TODO";

FilterOutput run_plush(const FilterInput& input, const PlushOptions& options, Progress& progress) {
    PlushSeams seams = segment_plush_seams(input.mesh, options, {}, {}, progress);
    FilterOutput output;
    output.values = {{"charts_number", seams.charts.count},
                     {"seam_length", seam_length(input.mesh, seams.charts)}};
    output.face_color = face_chart_colors(input.mesh, seams.charts);
    output.charts = std::move(seams.charts);
    return output;
}

} // namespace

std::vector<FilterDeclaration> plush_filters() {
    using O = PlushOptions;
    return {Declare<O>("Segmentation: Plush Toy Seams", "compute_segmentation_plush_seams_per_face",
                       FilterCategory::remeshing, plush_help)
                .real(&O::max_area_change, "max_area_change", "Largest change of area", 0.01, 1.0,
                      "x")
                .boolean(&O::symmetric, "symmetric", "s", "s")
                .writes(writes_charts | writes_color)
                .runs(run_plush)};
}

} // namespace devseg
