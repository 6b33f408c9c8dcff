#include "devseg/atlas/disks.h"
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* disks_help =
    "Cuts every chart open until it is a disk, which is what flattening needs: by shortest paths "
    "between its boundary loops, along short cycles through its handles, and by a slit if the "
    "chart is closed. Holes that lie flat need no slit: they stay holes. Cuts go around flat faces "
    "where they can. Tips that no flattening maps well, such as those of fingers and horns, are "
    "cut open as well.<br>"
    "Charts are read from the face attribute <b>chart_id</b>. Without it they are read from the "
    "wedge texture coordinates, and without those each connected component of the mesh is a chart. "
    "The cuts are added to <b>seam_edges</b>.<br>"
    "See:<br><i>Jeff Erickson, Sariel Har-Peled</i><br>"
    "<b>\"Optimally Cutting a Surface into a Disk\"</b><br>"
    "Discrete &amp; Computational Geometry 31, 2004, doi:10.1007/s00454-003-2948-z<br>"
    "<i>Hitoshi Yamauchi, Stefan Gumhold, Rhaleb Zayer, Hans-Peter Seidel</i><br>"
    "<b>\"Mesh Segmentation Driven by Gaussian Curvature\"</b><br>"
    "The Visual Computer 21, 2005, doi:10.1007/s00371-005-0319-x";

constexpr const char* colorize_help =
    "Gives each chart a colour, so that neighbours differ clearly. The same charts always get the "
    "same colours.<br>"
    "Charts are read from the face attribute <b>chart_id</b>. Without it they are read from the "
    "wedge texture coordinates, and without those each connected component of the mesh is a chart.";

FilterOutput run_disks(const FilterInput& input, const atlas::DiskOptions& options,
                       Progress& progress) {
    auto cutting = progress.part("cutting charts to disks", 1.0);
    atlas::DiskCuts cuts =
        atlas::cut_charts_to_disks(input.mesh, find_charts(input), options, cutting);
    FilterOutput output;
    output.values = {
        {"charts_number", cuts.charts.count},
        {"cut_charts_number", cuts.cut_charts},
        {"cut_tips_number", cuts.cut_tips},
        {"cut_length", cuts.cut_length * input.mesh.unit_length},
    };
    output.charts = std::move(cuts.charts);
    return output;
}

FilterOutput run_colorize(const FilterInput& input, const NoOptions&, Progress&) {
    const atlas::ChartMap charts = find_charts(input);
    FilterOutput output;
    output.values = {{"charts_number", charts.count}};
    output.face_color = face_chart_colors(input.mesh, charts);
    return output;
}

FilterDeclaration disks() {
    return Declare<atlas::DiskOptions>("Charts: Cut to Disks",
                                       "compute_seams_charts_to_disks_per_edge",
                                       FilterCategory::remeshing, disks_help)
        .boolean(
            &atlas::DiskOptions::cut_tips, "cut_tips", "Cut tips",
            "Cut charts open up to tips as well. Tips are vertices at least as far from the border "
            "as the border is long, and the ends of horns.")
        .writes(writes_charts)
        .result("charts_number", "charts, each a disk but for flat holes")
        .result("cut_charts_number", "charts that were cut")
        .result("cut_tips_number", "cuts up to tips")
        .result("cut_length", "length of the new cuts, model units")
        .runs(run_disks);
}

FilterDeclaration colorize() {
    return Declare<NoOptions>("Charts: Colorize", "compute_color_by_chart_per_face",
                              FilterCategory::color, colorize_help)
        .writes(writes_color)
        .result("charts_number", "charts that were coloured")
        .runs(run_colorize);
}

} // namespace

std::vector<FilterDeclaration> chart_filters() {
    return {disks(), colorize()};
}

} // namespace devseg::filters
