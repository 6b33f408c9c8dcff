#include <algorithm>
#include <cmath>

#include "devseg/atlas/disks.h"
#include "devseg/declare/declare.h"
#include "devseg/metrics/circle_maps.h"
#include "devseg/metrics/gauss_area.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* circle_help =
    "Measures how well charts can be flattened at all, without any flattening method: each chart "
    "is mapped to a disc, its boundary to the circle by length and its inside conformally, and the "
    "L2 stretch of that map is taken with the disc scaled to the chart's area.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>; without them "
    "from the wedge texture coordinates, and without those each connected component of the mesh is "
    "a chart. Those that are no disks are measured as 'Charts: Cut to Disks' opens them, without "
    "cuts to tips.<br>"
    "See:<br><i>Hitoshi Yamauchi, Stefan Gumhold, Rhaleb Zayer, Hans-Peter Seidel</i><br>"
    "<b>\"Mesh Segmentation Driven by Gaussian Curvature\"</b><br>"
    "The Visual Computer 21, 2005, doi:10.1007/s00371-005-0319-x<br>"
    "<i>Mathieu Desbrun, Mark Meyer, Pierre Alliez</i><br>"
    "<b>\"Intrinsic Parameterizations of Surface Meshes\"</b><br>"
    "Computer Graphics Forum 21(3), 2002, doi:10.1111/1467-8659.00580";

FilterOutput run_circle_maps(const FilterInput& input, const NoOptions&, Progress& progress) {
    auto cutting = progress.part("cutting charts to disks", 0.1);
    const atlas::DiskCuts cuts =
        atlas::cut_charts_to_disks(input.mesh, find_charts(input), cutting);
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

} // namespace

std::vector<FilterDeclaration> circle_map_filters() {
    return {Declare<NoOptions>("Charts: Measure Maps to the Circle", "get_circle_map_measures",
                               FilterCategory::measure, circle_help)
                .result("charts_number", "charts")
                .result("circle_l2_stretch", "mean over the charts, 1 for an isometry")
                .result("circle_l2_stretch_std", "standard deviation over the charts")
                .result("largest_circle_l2_stretch", "of the worst chart")
                .result("chart_circle_l2_stretch", "L2 stretch of each chart")
                .runs(run_circle_maps)};
}

} // namespace devseg::filters
