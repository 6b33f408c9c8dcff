#include <algorithm>
#include <string>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/disks.h"
#include "devseg/atlas/flat_cuts.h"
#include "devseg/declare/declare.h"
#include "devseg/develop/deform.h"
#include "devseg/develop/moved_parts.h"
#include "devseg/develop/stiff_faces.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* deform_help =
    "Moves the vertices as little as possible until every chart can be laid flat <i>exactly</i>, "
    "like paper: until the angles around every vertex inside of a chart sum up to 360 degrees. "
    "Vertices on the borders of charts and on slits are free. Connectivity stays, no face is turned "
    "over or collapses. 'Charts: Flatten' then unfolds the charts without any stretch.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>, whichever "
    "method made them; without them from the texture coordinates, and without those each connected "
    "component of the mesh is a chart. Charts that are not disks are cut first; holes that lie flat exactly stay. Where the tolerance "
    "is not reached the mesh stays as it is, unless the best state is asked for.<br>"
    "See:<br><i>Kuniko Takahashi, Tomohiro Tachi, Yasushi Yamaguchi</i><br>"
    "<b>\"Mesh Approximation for Generating Development with Creases and Slits\"</b><br>"
    "Journal for Geometry and Graphics 19(1), 2015, pages 119-129<br>"
    "<i>Tomohiro Tachi</i><br>"
    "<b>\"Freeform Variations of Origami\"</b><br>"
    "Journal for Geometry and Graphics 14(2), 2010, pages 203-215";

// Numbers 0 … n − 1 of the host's vertices that the mesh uses.
std::vector<Index> shared_points(const std::vector<Index>& source_vertex) {
    std::vector<Index> sources = source_vertex;
    std::sort(sources.begin(), sources.end());
    sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
    std::vector<Index> point_of;
    for (const Index source : source_vertex)
        point_of.push_back(static_cast<Index>(
            std::lower_bound(sources.begin(), sources.end(), source) - sources.begin()));
    return point_of;
}

// Only holes around which the charts unfold exactly stay without a slit.
atlas::DiskCuts cut_for_paper(const Mesh& mesh, const atlas::ChartMap& charts, Progress& progress) {
    return atlas::cut_charts_to_disks(mesh, charts, {false, {}, atlas::HoleRule::exact()},
                                      progress);
}

struct Trial {
    develop::DeformResult result;
    Index cut_charts = 0; // to disks, before
    double cost = 0.0;    // of all cuts
};

Trial run_trial(const FilterInput& input, const atlas::ChartMap& charts,
                const std::vector<Index>& points, const develop::DeformOptions& options,
                Progress& progress) {
    const Mesh& mesh = input.mesh;
    auto cutting = progress.part("cutting charts to disks", 0.03);
    const Mesh start =
        options.keep_holes
            ? develop::with_points(mesh, develop::find_stiff_faces(mesh, points).points)
            : mesh;
    const atlas::DiskCuts cuts = cut_for_paper(start, charts, cutting);
    auto deforming = progress.part(0.94);
    Trial trial{develop::deform_to_developable(mesh, cuts.charts, points, options, deforming),
                cuts.cut_charts};
    // What was moved beside a hole may have opened it.
    auto opening = progress.part("cutting charts to disks", progress.left());
    trial.result.charts =
        cut_for_paper(develop::with_points(mesh, trial.result.points), trial.result.charts, opening)
            .charts;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h && trial.result.charts.seam[h] != 0)
            trial.cost += atlas::cut_cost(mesh, h);
    return trial;
}

// Holes of flat faces stay exact where that costs no other cuts: a face that stands still may need
// more of them around it than one through it.
Trial run_trials(const FilterInput& input, const std::vector<Index>& points,
                 const develop::DeformOptions& options, Progress& progress) {
    const atlas::ChartMap charts = find_charts(input);
    develop::DeformOptions free = options;
    free.keep_holes = false;
    if (atlas::flat_faces_with_holes(input.mesh).empty())
        return run_trial(input, charts, points, free, progress);
    develop::DeformOptions stiff = options;
    stiff.keep_unfinished = true;
    auto first = progress.part(0.5);
    Trial held = run_trial(input, charts, points, stiff, first);
    const bool is_good = held.result.converged && held.result.new_intersections == 0;
    if (is_good && held.result.added_slits == 0)
        return held;
    auto second = progress.part(progress.left());
    Trial moved = run_trial(input, charts, points, free, second);
    return is_good && held.cost <= moved.cost ? held : moved;
}

FilterOutput run_deform(const FilterInput& input, const develop::DeformOptions& options,
                        Progress& progress) {
    const Mesh& mesh = input.mesh;
    const std::vector<Index> points = shared_points(input.source_vertex);
    auto trying = progress.part(0.75);
    Trial trial = run_trials(input, points, options, trying);
    develop::DeformResult& result = trial.result;
    auto moving = progress.part(progress.left());
    if (options.adjust_slits && result.converged)
        develop::move_parts(mesh, points, options, result, moving);
    FilterOutput output;
    const double unit = mesh.unit_length;
    output.values = {
        {"charts_number", result.charts.count},
        {"inner_vertices_number", result.inner_vertices},
        {"initial_residual", result.start_residual},
        {"residual", result.residual},
        {"converged", result.converged},
        {"rounds_number", result.rounds},
        {"largest_displacement", result.largest_displacement * unit},
        {"mean_displacement", result.mean_displacement * unit},
        {"added_slits_number", result.added_slits},
        {"closed_edges_number", result.closed_edges},
        {"moved_parts_number", result.moved_parts},
        {"added_intersections_number", result.new_intersections},
    };
    if (trial.cut_charts > 0)
        output.notes.push_back(std::to_string(trial.cut_charts) +
                               " charts had to be cut open to disks first");
    if (result.added_slits > 0)
        output.notes.push_back(std::to_string(result.added_slits) +
                               " slits were cut to vertices that could not be made developable");
    if (!result.converged)
        output.notes.emplace_back("the tolerance was not reached: this is the best state");
    output.charts = std::move(result.charts);
    output.points = std::move(result.points);
    return output;
}

} // namespace

std::vector<FilterDeclaration> deformation_filters() {
    using O = develop::DeformOptions;
    return {
        Declare<O>("Charts: Deform to Exact Developability", "apply_coord_developable_charts",
                   FilterCategory::remeshing, deform_help)
            .integer(&O::max_iterations, "Most rounds",
                     "Rounds of the projection; one for a part of the charts counts by that part. "
                     "It ends when only rounding is left.")
            .real(&O::tolerance, "Tolerance",
                  "What the angles around an inner vertex may differ from 360 degrees, in radians. "
                  "Hosts that keep coordinates in 32 bit round to about 0.00001.")
            .boolean(&O::adjust_slits, "adjust_slits", "Adjust slits",
                     "Cut slits to vertices that cannot be made developable, and close slits whose "
                     "sides would overlap in the plane. Off: seams stay as they are.")
            .boolean(&O::keep_unfinished, "keep_unfinished", "Keep the best state",
                     "Where the tolerance is not reached, take the best state instead of leaving "
                     "the mesh as it is.")
            .real(&O::max_displacement, "Largest displacement",
                  "How far a vertex may move, as a share of the diagonal of the model's box; where "
                  "more would be needed, slits are cut (with 'Adjust slits'). 0 = no limit.")
            .real(&O::max_mean_displacement, "Largest mean displacement",
                  "The same share for the mean over all vertices. 0 = no limit.")
            .writes(writes_charts | writes_points)
            .result("charts_number", "charts, each a disk but for flat holes")
            .result("inner_vertices_number", "vertices inside of charts, whose angles count")
            .result("initial_residual", "largest difference of an inner vertex from 360 degrees "
                                        "before, radians")
            .result("residual", "the same after, radians")
            .result("converged", "whether the tolerance was reached")
            .result("rounds_number", "rounds of the projection")
            .result("largest_displacement", "of a vertex, model units")
            .result("mean_displacement", "over all vertices, model units")
            .result("added_slits_number", "slits that were cut")
            .result("closed_edges_number", "edges of slits that were closed")
            .result("moved_parts_number",
                    "parts that lay on others of their chart and went to another one")
            .result("added_intersections_number",
                    "pairs of faces that run through each other and did not before")
            .runs(run_deform)};
}

} // namespace devseg::filters
