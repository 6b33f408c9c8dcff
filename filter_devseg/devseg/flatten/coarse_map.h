// Large charts by way of a coarse version: flattened and pushed apart on few faces, and then
// refined to all of them. That costs less than pushing all faces, and finds maps in one piece that
// this does not find.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "devseg/flatten/flatten.h"
#include "devseg/mesh/coarsen.h"

namespace devseg::flatten {

/// Charts of more faces are decimated to so many where their map decides something. With half as
/// many, more of them look flat that are not.
constexpr Index coarse_map_faces = 8000;

struct CoarseMap {
    Mesh chart;              // all faces of the chart, as a mesh of their own
    mesh::CoarseMesh coarse; // of `chart`
    FlatChart flat;          // of `coarse.mesh`, see flatten_whole
};

/// The map of a chart of that many faces at most, the same for any number of threads. Where its
/// parts overlap, and `may_push` says so, they are pushed farther apart than paper needs, so that
/// finer borders have room. Without uv where the coarse chart has no map.
CoarseMap map_coarsely(
    const Mesh& mesh, const atlas::ChartSurface& surface, Index most_faces,
    const std::function<bool(const FlatteningProblem&, const std::vector<Vec2>&)>& may_push,
    const Progress& progress);

/// The map of all faces (#v of the surface) that refines it, near to the one of least energy;
/// nothing where that is not one-to-one, or the chart is exactly developable: those are not pushed.
/// `problem` is that of the surface.
std::optional<std::vector<Vec2>> refine_coarse_map(const Mesh& mesh,
                                                   const atlas::ChartSurface& surface,
                                                   const FlatteningProblem& problem,
                                                   CoarseMap coarse, const Progress& progress);

/// The map of all faces that a chart gets which cannot be pushed apart on all faces; nothing for
/// charts that are not large.
std::optional<std::vector<Vec2>> map_by_coarse(const Mesh& mesh, const atlas::ChartSurface& surface,
                                               const FlatteningProblem& problem,
                                               const Progress& progress);

} // namespace devseg::flatten
