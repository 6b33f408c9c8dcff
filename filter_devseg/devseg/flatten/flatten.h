// Flattening all charts of a segmentation, in parallel, each with its own area and without
// flipped or overlapping faces.
#pragma once

#include <functional>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// LPFB keeps the lengths of boundary edges: with the least strain inside, or with even areas.
enum class FlattenMethod { symmetric_dirichlet, lscm, abf, arap, lpfb, lpfb_even_areas };

/// One chart in the plane: positively oriented, no face flipped, with its own 3D area (LPFB: with
/// the lengths of its boundary edges instead).
struct FlatChart {
    atlas::ChartSurface surface;
    std::vector<Vec2> uv;   // #v, internal units of the mesh
    bool mended = false;    // the chosen method flipped faces: the injective one was used instead
    bool pushed = false;    // parts overlapped and were pushed apart
    bool cut_off = false;   // a part of a given chart that overlapped another part
    bool torn = false;      // no map in one piece was found; `uv` is the last one, if there is any
    bool developed = false; // exactly developable, and unfolded instead of mapped
    bool converged = true;
    double energy = 0.0; // symmetric Dirichlet energy, 1 for an isometry
};

struct FlattenResult {
    atlas::ChartMap charts; // the given charts, cut where parts overlapped
    std::vector<FlatChart> flat;
    int cuts = 0;       // that were needed
    int reattached = 0; // parts that were hinged to another chart after that
};

/// Flattens every chart; all must be sound (see atlas/holes.h). Holes stay,
/// unless the method finds no map around them. Parts of a chart that overlap in the plane
/// are pushed apart where the method is symmetric Dirichlet and that changes the shape little, and
/// else cut apart along a short path; what is then too small to be a chart goes to a neighbour
/// whose map has room for it. Charts that are exactly developable are unfolded, whatever the
/// method: only cut apart, never pushed, and small parts are hinged to another chart; slits whose
/// sides lie on each other by less than `slit_gap` are opened by as little. The result does not
/// depend on the number of threads. Throws NumericalFailure, naming the chart's size,
/// where no map without flips could be found.
FlattenResult flatten_charts(const Mesh& mesh, const atlas::ChartMap& charts, FlattenMethod method,
                             Progress& progress);

/// What a chart that must stay in one piece has to keep to. Called from all threads.
struct WholeChart {
    /// Whether a map is good enough but for parts that overlap, which are pushed apart then.
    std::function<bool(const FlatteningProblem&, const std::vector<Vec2>& uv)> is_good;
    bool push_apart = true; // parts that overlap
};

/// The same without cutting anything apart: where that would be done, the chart is `torn`, and its
/// map the last one.
std::vector<FlatChart> flatten_whole(const Mesh& mesh, const atlas::ChartMap& charts,
                                     FlattenMethod method, const WholeChart& whole,
                                     Progress& progress);

/// Joins parts that were cut off and are too small to be charts of their own to a neighbour, along
/// their whole common border, where its map stays one-to-one and is stretched little more; the
/// others stay. Keeps result.charts and result.flat in step.
void hand_over_slivers(const Mesh& mesh, FlattenMethod method, FlattenResult& result,
                       Progress& progress);

/// Parts of exact developments that were separated go to a neighbour, also an exact development,
/// the smallest part first: across one edge, or several between which all angles are exact, as on
/// straight creases. That keeps the development exact, and is long enough to hold the part. Returns
/// how many.
int reattach_parts(const Mesh& mesh, FlattenResult& result, Progress& progress);

} // namespace devseg::flatten
