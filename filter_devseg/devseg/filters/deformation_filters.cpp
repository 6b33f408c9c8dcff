#include <algorithm>
#include <string>

#include "devseg/atlas/disks.h"
#include "devseg/declare/declare.h"
#include "devseg/develop/deform.h"
#include "devseg/develop/moved_parts.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* deform_help =
    "Moves the vertices as little as possible until every chart can be laid flat <i>exactly</i>, "
    "like paper: until the angles around every vertex inside of a chart sum up to 360 degrees. "
    "Vertices on the borders of charts and on slits are free. Connectivity stays, no face is "
    "turned over or collapses. 'Charts: Flatten' then unfolds the charts without any stretch.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>, whichever "
    "method made them; without them from the texture coordinates, and without those each connected "
    "component of the mesh is a chart. Charts that are not disks are cut first; holes that lie "
    "flat exactly stay. Where the tolerance is not reached the mesh stays as it is, unless the "
    "best state is asked for.<br>"
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

FilterOutput run_deform(const FilterInput& input, const develop::DeformOptions& options,
                        Progress& progress) {
    auto cutting = progress.part("cutting charts to disks", 0.02);
    const atlas::DiskCuts cuts = cut_for_paper(input.mesh, find_charts(input), cutting);
    auto deforming = progress.part(0.7);
    const std::vector<Index> points = shared_points(input.source_vertex);
    develop::DeformResult result =
        develop::deform_to_developable(input.mesh, cuts.charts, points, options, deforming);
    // What was moved beside a hole may have opened it.
    Mesh moved = input.mesh;
    moved.points = result.points;
    mesh::compute_face_geometry(moved);
    auto opening = progress.part("cutting charts to disks", 0.02);
    result.charts = cut_for_paper(moved, result.charts, opening).charts;
    auto moving = progress.part(progress.left());
    if (options.adjust_slits && result.converged)
        develop::move_parts(input.mesh, points, options, result, moving);
    FilterOutput output;
    const double unit = input.mesh.unit_length;
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
    if (cuts.cut_charts > 0)
        output.notes.push_back(std::to_string(cuts.cut_charts) +
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
                  "How far a vertex may move, as a share of the diagonal of the model's box. Where "
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
