// Flat faces of several triangles: whole in one chart, with cuts led around them.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::atlas {

/// 1 for the half-edges (3 #F) within flat regions that are seen as one face: a thousandth of the
/// surface or more.
std::vector<std::uint8_t> within_flat_faces(const Mesh& mesh);

/// Such a region that has holes.
struct HoledFace {
    std::vector<Index> faces;
    std::vector<HalfEdge> holes; // around them, of its faces: all contours but the longest
};
std::vector<HoledFace> flat_faces_with_holes(const Mesh& mesh);

/// 1 for the half-edges (3 #F, symmetric) around the holes of flat faces: all their contours but
/// the longest. A chart that has the face and what stands in one of its holes could be opened
/// there only through the face, and would lie on it. Holes of what would be left alone then, but
/// is too small to be seen, do not count.
std::vector<std::uint8_t> rims_of_flat_faces(const Mesh& mesh);

/// Gives every flat region to the chart that has most of it. What comes new to a chart is glued
/// within its plane, and hangs on the rest by its longest edges, one for each part. Charts may fall
/// apart or vanish; they need not be sound then.
ChartMap keep_flat_faces_whole(const Mesh& mesh, const ChartMap& charts);

/// Glues the cuts inside charts that run between faces of one plane, and opens the charts anew:
/// shortest paths lead from their border to each vertex that is not flat (`cost` (#V, radians)
/// above `flat`) and had a cut, and to the loops that are left. The charts that have less cuts
/// through flat faces then, or as many that cost less (see cut_cost), get the new ones. Charts stay
/// sound.
void lead_around_flat_faces(const Mesh& mesh, const std::vector<double>& cost, double flat,
                            ChartMap& charts, Progress& progress);

} // namespace devseg::atlas
