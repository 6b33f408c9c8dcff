// Flat charts made fit for sewing: no overlaps, no crumbs of cloth, no darts that do not open.
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005, section 4. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/flatten/flatten.h"
#include "devseg/pack/pack.h"

namespace devseg::pattern {

struct OptimizeOptions {
    bool remove_overlaps = true;   // cut off the parts of a chart that lie on other parts of it
    bool reattach_gussets = true;  // join small charts to a neighbour where that is developable
    double max_gusset_area = 0.02; // a chart is small below this share of the model's area
    double merge_threshold = 0.01; // largest mean fitting error of a small chart with a neighbour's
                                   // proxy, no unit
    double max_dart_angle = 3.0;   // degrees: narrower darts are glued; 0 = none
    pack::PackEffort effort = pack::PackEffort::normal; // where charts have to be packed anew
};

/// Charts in the plane with their face numbers: chart c is flat[c].
struct FlatLayout {
    atlas::ChartMap charts;
    std::vector<flatten::FlatChart> flat; // uv in internal units, positively oriented
    Index overlap_cuts = 0;               // that were made
    Index reattached = 0;                 // small charts that were joined to a neighbour
    bool is_as_given = true;              // no chart needed another scale
};

/// The charts of texture coordinates at one scale (atlas::even_layout); mirrored ones turned over.
/// Throws InvalidMesh for a layout without area.
FlatLayout read_layout(const Mesh& mesh, const CornerUv& uv);

/// Cuts every chart that lies on itself apart along short paths, until none does.
void remove_overlaps(const Mesh& mesh, FlatLayout& layout, Progress& progress);

/// Joins small charts to a neighbour [JKS05, section 4]: the neighbours in the order of their
/// common border; the first that the proxies allow (sections 2.1.1 and 3.3), that makes a disk
/// whose map has no overlap, and whose map is no worse than that of the parts by more than 2 % of
/// the symmetric Dirichlet energy. The union is flattened anew, by LPFB where the layout keeps the
/// lengths of all boundaries.
void reattach_gussets(const Mesh& mesh, const OptimizeOptions& options, FlatLayout& layout,
                      Progress& progress);

struct GluedDarts {
    atlas::ChartMap charts;
    CornerUv uv;
    Index edges = 0; // that were glued
    Index darts = 0; // that became shorter or vanished
};

/// Glues darts from their tips on, as long as the angles around the tip sum up to a full turn
/// within `angle` (radians): both copies of a vertex move to the middle, rounded to 32 bit. Edges
/// that would turn a face over, or close the chart's only boundary, stay open.
GluedDarts glue_darts(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv,
                      double angle);

} // namespace devseg::pattern
