// Flattening all charts of a segmentation, in parallel, each with its own area.
#pragma once

#include <string>
#include <vector>

#include "devseg/mesh/charts.h"
#include "devseg/progress.h"

namespace devseg {

enum class FlattenMethod { symmetric_dirichlet, lscm };

/// One chart in the plane: positively oriented, with its own 3D area, no face flipped.
struct FlatChart {
    ChartSurface surface;
    std::vector<Vec2> uv; // #v, internal units of the mesh
    bool mended = false;  // the chosen method flipped faces: the injective one was used instead
    bool converged = true;
    double energy = 0.0;  // symmetric Dirichlet energy, 1 for an isometry
};

/// Flattens every chart; all must be disks. The result does not depend on the number of threads.
/// Throws NumericalFailure, naming the chart, where no map without flips could be found.
std::vector<FlatChart> flatten_charts(const Mesh& mesh, const ChartMap& charts,
                                      FlattenMethod method, Progress& progress);

} // namespace devseg
