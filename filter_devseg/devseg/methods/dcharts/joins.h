// Joins of charts [JKS05, section 3.3]: borders are closed, as a whole or in part, where a trial
// shows that the joined chart lies flat.
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include "devseg/judge/final_map.h"
#include "devseg/methods/dcharts/draft.h"

namespace devseg::dcharts {

struct MergeOptions {
    StretchBounds chart;          // of each joined chart
    double max_excess = infinite; // of the draft, see Draft::excess
    // Least length of border that a join saves, over the root of the smaller chart's area: charts
    // that touch along a short border would hang together by a narrow neck.
    double least_neck = 0.5;
    double small_share = 0.01; // of the surface: smaller charts are joined to a neighbour anyway
    Index enough_charts = 0; // nothing is closed any more where there are no more charts than this
    // Where no whole border can be closed any more, parts of them are, while there are more charts.
    Index parts_above = 0;
    // Corners of the surface stay on seams, and borders are closed up to them: what is a polyhedron
    // becomes its net.
    bool keep_corners = false;
    // In the end cuts inside charts are tried in other places, where they are shorter.
    bool exchange_cuts = false;
    // Trials on a coarse surface take less time. They do not tell well which of two closings is the
    // better one, where the fewest charts and the shortest seams are wanted.
    bool coarse_trials = true;
    // A join counts only if the final map of the joined chart keeps the bounds: for the surface
    // itself. Else trials decide.
    bool confirm = false;
    judge::MapFor purpose = judge::MapFor::texture; // of that map
    std::vector<std::uint8_t> open; // of each chart: joins need one of these; empty: any will do
};

/// Closes seams one at a time, those first that are long and whose joined map costs little stretch;
/// neighbours are tried again after each. A seam between two charts is closed along their whole
/// common border, or along a part of it, which leaves the rest as a cut inside the joined chart; a
/// cut inside a chart is closed where the chart stays flat.
void merge_charts(const Mesh& mesh, const MergeOptions& options, Draft& draft, Progress& progress);

/// The same for growing bounds of the draft's excess: a draft for each, which goes on from the one
/// before, with all that the trials of that have found.
std::vector<Draft> merge_charts_in_steps(const Mesh& mesh, MergeOptions options,
                                         const std::vector<double>& max_excess, Draft draft,
                                         Progress& progress);

} // namespace devseg::dcharts
