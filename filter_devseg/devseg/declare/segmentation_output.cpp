#include "devseg/declare/segmentation_output.h"

#include <utility>

#include "devseg/declare/chart_colors.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::declare {

FilterOutput segmentation_output(const FilterInput& input, const std::vector<Index>& labels,
                                 std::vector<double> face_quality,
                                 const atlas::DiskOptions& options, Progress& progress) {
    auto cutting = progress.part("cutting charts to disks", 1.0);
    atlas::DiskCuts cuts = atlas::cut_charts_to_disks(
        input.mesh, atlas::make_chart_map(input.mesh, labels, {}, false), options, cutting);
    FilterOutput output;
    output.values = {
        {"charts_number", cuts.charts.count},
        {"cut_length", cuts.cut_length * input.mesh.unit_length},
        {"seam_length", metrics::seam_length(input.mesh, cuts.charts)},
    };
    output.face_color = face_chart_colors(input.mesh, cuts.charts);
    output.face_quality = std::move(face_quality);
    output.charts = std::move(cuts.charts);
    return output;
}

} // namespace devseg::declare
