// The filters that change the charts that the user has chosen.
#include <string>
#include <utility>

#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/edit/chosen.h"
#include "devseg/edit/edits.h"
#include "devseg/edit/given_charts.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::edit {

using namespace declare;

namespace {

template <class Fields>
struct Options : EditBounds, Fields {
    static OptionRanges<Options> ranges() {
        return {{&Options::max_chart_l2_stretch, EditBounds::ranges().front().second}};
    }
};
struct JoinFields {
    std::string pieces;
};
struct SplitFields {
    std::string pieces;
    bool along_selection = true;
};
struct SeamFields {
    std::string seams;
    bool whole_seams = true;
};
struct DartFields {
    std::string vertices;
};
using JoinOptions = Options<JoinFields>;
using SplitOptions = Options<SplitFields>;
using SeamOptions = Options<SeamFields>;
using DartOptions = Options<DartFields>;

constexpr const char* join_help =
    "Joins the charts that the selected faces touch to one, and judges that by flattening it. It "
    "is refused, with the stretch that it would cost, where the joined chart stretches by more "
    "than a bound, or would lie on itself. A joined chart that is no disk is cut open. One of more "
    "than 8,000 faces is judged decimated to so many first.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>; without them "
    "from the wedge texture coordinates. Scripts name charts by their numbers on the pattern. "
    "Flatten the charts afterwards.";

constexpr const char* split_help =
    "Splits the charts that the selected faces touch, along the borders of the selected faces and "
    "along selected edges. Edges are led on to the chart's border. Charts that these do not divide "
    "are split the best way in two, as 'Segmentation: D-Charts' splits charts above their "
    "bound.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>; without them "
    "from the wedge texture coordinates. Scripts name charts by their numbers on the pattern. "
    "Flatten the charts afterwards.";

constexpr const char* remove_help =
    "Takes away the seams that lie between selected faces, or, where no face is selected, the "
    "selected edges. Charts on both sides are joined, and darts are closed. It is refused, with "
    "the stretch that it would cost, where a chart stretches by more than a bound then, or would "
    "lie on itself.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>; without them "
    "from the wedge texture coordinates. Scripts name seams by their numbers on the pattern. "
    "Flatten the charts afterwards.";

constexpr const char* dart_help =
    "Cuts a dart to each selected vertex: a short path from the border of its chart, or from "
    "another dart, on which creases count less. It is refused where that does not lower the "
    "stretch.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>; without them "
    "from the wedge texture coordinates. Flatten the charts afterwards.";

FilterOutput edit_output(const FilterInput& input, Edit edit) {
    FilterOutput output;
    output.face_color = face_chart_colors(input.mesh, edit.charts);
    output.values = {{"charts_number", edit.charts.count},
                     {"changed_charts_number", edit.changed},
                     {"l2_stretch", edit.l2_stretch},
                     {"linf_stretch", edit.linf_stretch},
                     {"cut_length", edit.cut_length * input.mesh.unit_length},
                     {"seam_length", metrics::seam_length(input.mesh, edit.charts)}};
    output.charts = std::move(edit.charts);
    return output;
}

FilterOutput run_join(const FilterInput& input, const JoinOptions& options, Progress& progress) {
    const atlas::ChartMap charts = find_charts(input);
    const std::vector<Index> which = chosen_charts(input, charts, options.pieces, progress);
    return edit_output(input, join_charts(input.mesh, charts, which, options, progress));
}

FilterOutput run_split(const FilterInput& input, const SplitOptions& options, Progress& progress) {
    const atlas::ChartMap charts = find_charts(input);
    const std::vector<Index> which = chosen_charts(input, charts, options.pieces, progress);
    std::vector<std::uint8_t> cuts;
    if (options.along_selection && options.pieces.empty()) {
        cuts.assign(input.mesh.twin.size(), 0);
        if (!input.selected.empty())
            cuts = borders_of(input.mesh, input.selected);
        for (std::size_t h = 0; h < input.selected_edges.size(); ++h)
            cuts[h] |= input.selected_edges[h];
    }
    return edit_output(input, split_charts(input.mesh, charts, which, cuts, options, progress));
}

FilterOutput run_remove(const FilterInput& input, const SeamOptions& options, Progress& progress) {
    const atlas::ChartMap charts = find_charts(input);
    const std::vector<std::uint8_t> marks =
        chosen_seams(input, charts, options.seams, options.whole_seams, progress);
    return edit_output(input, remove_seams(input.mesh, charts, marks, options, progress));
}

FilterOutput run_dart(const FilterInput& input, const DartOptions& options, Progress& progress) {
    const std::vector<Index> vertices = chosen_vertices(input, options.vertices);
    Edit edit = add_darts(input.mesh, find_charts(input), vertices, options, progress);
    const double before = edit.l2_before;
    FilterOutput output = edit_output(input, std::move(edit));
    output.values.emplace_back("l2_stretch_before", before);
    return output;
}

template <class O>
Declare<O> edit(const char* menu_name, const char* python_name, const char* help) {
    return Declare<O>(menu_name, python_name, FilterCategory::remeshing, help)
        .needs_selection()
        .writes(writes_charts | writes_color)
        .result("charts_number", "charts, those that nothing has changed included")
        .result("changed_charts_number", "charts that are new or other than they were")
        .result("l2_stretch", "L2 stretch of the worst of these, flattened in one piece, no unit")
        .result("linf_stretch", "stretch of their worst spot, no unit")
        .result("cut_length", "length of darts, and of cuts that made disks of them, model units")
        .result("seam_length", "length of all cut edges, model units");
}

template <class O>
Declare<O> forced(Declare<O> filter, const char* help) {
    return filter.boolean(&O::force, "force", "Even so", help);
}

template <class O>
Declare<O> bounded(Declare<O> filter) {
    filter.real(
        &O::max_chart_l2_stretch, "Largest L2 stretch of a chart",
        "Bound of the L2 stretch of what is joined, above 1, without unit; 0 for no bound.");
    return forced(std::move(filter), "Join charts above the bound as well, or such that lie on "
                                     "themselves and will be cut apart.");
}

template <class O>
Declare<O> named(Declare<O> filter) {
    return filter.text(&O::pieces, "pieces", "Pieces",
                       "Numbers of charts on the pattern of the texture coordinates, such as 3,5. "
                       "Empty: those that the selection touches.");
}

} // namespace

std::vector<FilterDeclaration> edit_filters() {
    return {bounded(named(edit<JoinOptions>("Charts: Join Selected", "apply_charts_join_selected",
                                            join_help)))
                .runs(run_join),
            forced(named(edit<SplitOptions>("Charts: Split Selected", "apply_charts_split_selected",
                                            split_help))
                       .boolean(&SplitOptions::along_selection, "along_selection",
                                "Along the selection",
                                "Split along the borders of the selected faces and along selected "
                                "edges. Off: always the best way in two."),
                   "Split off parts that are slivers as well.")
                .runs(run_split),
            bounded(edit<SeamOptions>("Charts: Remove Selected Seams",
                                      "apply_charts_remove_selected_seams", remove_help)
                        .text(&SeamOptions::seams, "seams", "Seams",
                              "Numbers of seams on the pattern of the texture coordinates, such as "
                              "14,15. Empty: those that are selected.")
                        .boolean(&SeamOptions::whole_seams, "whole_seams", "Whole seams",
                                 "Take all of a seam away that is selected in part, from one "
                                 "junction to the next. Off: what is not selected stays a cut."))
                .runs(run_remove),
            forced(edit<DartOptions>("Charts: Add Dart", "apply_charts_add_dart", dart_help)
                       .text(&DartOptions::vertices, "vertices", "Vertices",
                             "Numbers of vertices where darts end, counted from 0, such as 120,7. "
                             "Empty: the selected ones."),
                   "Cut darts that gain nothing as well.")
                .result("l2_stretch_before", "the same without the darts")
                .runs(run_dart)};
}

} // namespace devseg::edit
