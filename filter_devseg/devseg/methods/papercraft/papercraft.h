// Segmentation for papercraft: few charts with creases and slits, found by the angles around
// vertices.
//
// References
//   [TTY15] K. Takahashi, T. Tachi, Y. Yamaguchi: Mesh Approximation for Generating Development
//           with Creases and Slits. Journal for Geometry and Graphics 19(1), 2015, pages 119 to
//           129.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"

namespace devseg::papercraft {

/// Whether charts are made for a deformation, which makes them exact, or are exact as they are.
enum class Deform { automatic, always, never };

struct PapercraftOptions {
    int charts_number = 20;
    Deform deform = Deform::automatic;
    int max_net_faces = 0;         // those of one plane being one; 0: no limit
    double growth_threshold = 0.5; // radians that a chart of the initial segmentation may cost
    double slit_threshold = 0.1;   // largest E_s of a slit that is closed, share of the diagonal
    int max_iterations = 100;      // rounds of the chart selection
    int random_seed = 0;

    static OptionRanges<PapercraftOptions> ranges();
};

struct PapercraftResult {
    atlas::ChartMap charts;           // sound; slits are seams inside of charts
    std::vector<double> defect_share; // #F: angle defects of its vertices, each split among its
                                      // faces, radians
    Index initial_charts = 0;
    int rounds = 0;
    double slit_length = 0.0; // internal units
    Index closed_edges = 0;   // of slits
    Index nets = 0;           // charts that unfold as they are
};

/// Charts grow by vertices [TTY15, section 3.2.1]; the smallest ones are removed and all others
/// grown again until `charts_number` are left (section 3.2.2; many at a time while far too many
/// are left); slits are closed by equation 6 (section 3.2.4). Differences to the paper: costs are
/// taken of defects from which the noise of scans is averaged out, vertices with more than half a
/// radian are never taken inside of a chart, and a threshold with which there are not enough
/// initial charts is lowered. Components of few flat faces become nets (nets.h) instead, as many as
/// it takes; with `deform` never all do, with always none. Throws InvalidParameter.
PapercraftResult segment_papercraft(const Mesh& mesh, const PapercraftOptions& options,
                                    Progress& progress);

} // namespace devseg::papercraft
