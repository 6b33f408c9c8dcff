// Isometric maps of large charts: solved on a coarse version, then refined vertex by vertex.
//
// References
//   K. Hormann, G. Greiner, S. Campagna: Hierarchical Parametrization of Triangulated Surfaces.
//   Vision, Modeling and Visualization 1999.
#pragma once

#include <functional>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/mesh/coarsen.h"

namespace devseg::flatten {

/// Charts with fewer faces are flattened at once; the coarse version of others has a third as many.
constexpr Index multilevel_threshold = 6000;

/// Finds a map of a coarse version of the chart with `solve`, puts the removed vertices back one
/// by one into the kernels of their neighbourhoods, which never flips a face, and relaxes all
/// vertices after each doubling of their number. uv is #v of `surface`. Throws what `solve` throws,
/// and NumericalFailure where rounding left no valid place for a vertex.
std::vector<Vec2> flatten_multilevel(
    const Mesh& mesh, const atlas::ChartSurface& surface, const FlatteningProblem& problem,
    const std::function<std::vector<Vec2>(const FlatteningProblem&, const atlas::ChartSurface&)>&
        solve,
    const Progress& progress);

/// The second half of that alone: `uv` (#v of `chart`, a chart as a mesh of its own) is a map of
/// its coarse version without flips, `problem` that of all its faces. With `hold_boundary` vertices
/// of the boundary stay where they are put back. Throws NumericalFailure as above.
std::vector<Vec2> refine_map(const Mesh& chart, mesh::CoarseSurface coarse, std::vector<Vec2> uv,
                             const FlatteningProblem& problem, bool hold_boundary,
                             const Progress& progress);

} // namespace devseg::flatten
