// Length-preserved free boundary: flattening that keeps every boundary edge at its length, so that
// both sides of a seam stay equally long.
//
// References
//   R. Goldenthal, D. Harmon, R. Fattal, M. Bercovier, E. Grinspun: Efficient Simulation of
//   Inextensible Cloth. ACM Transactions on Graphics 26(3), 2007. doi:10.1145/1276377.1276438 (the
//   fast projection of restore_lengths)
#pragma once

#include <optional>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

struct LpfbOptions {
    int max_rounds = 50;     // steps of each boundary solver at most
    double tolerance = 1e-5; // radians; the boundary is settled when no angle moves by more
};

/// Which solver closed the boundary, in the order in which they are tried.
enum class BoundarySolver {
    newton,             // the nearest angles, from the chart's own
    newton_from_closed, // the nearest angles, from a boundary that least-norm steps had closed
    least_norm          // a closed boundary by the shortest steps: near, but not the nearest
};

struct ClosedBoundary {
    std::vector<double> angles; // #boundary: inner angle at each vertex, radians
    std::vector<Vec2> points;   // #boundary, counterclockwise
    double closure = 0.0;       // length of the gap that is left / length of the boundary
    double deviation = 0.0;     // root mean square change of the angles, radians
    BoundarySolver solver = BoundarySolver::newton;
    int rounds = 0; // steps of all solvers together
};

struct LpfbResult {
    std::vector<Vec2> uv;    // #v
    Index flips = 0;         // above 0 where the boundary crosses itself: the map is not valid
    ClosedBoundary boundary; // how the boundary was closed
    Index mended = 0;        // inner vertices at mean-value instead of cotangent weights
};

/// The closed polygon with edge i of length lengths[i], from vertex i to i + 1, and inner angles as
/// near to `targets` (radians) as possible. The polygon may cross itself. Throws NumericalFailure
/// when no polygon has these lengths, as when one edge is longer than all others together.
ClosedBoundary close_boundary(const std::vector<double>& lengths,
                              const std::vector<double>& targets, const LpfbOptions& options,
                              const Progress& progress);

/// Angle sums at the vertices of the boundary, in its order, radians: in a map (#v), or in space if
/// there is none.
std::vector<double> boundary_angles(const FlatteningProblem& problem,
                                    const std::vector<Vec2>& map = {});

/// LPFB: the boundary from its lengths and its angles on the surface, inner vertices in balance.
/// Neither scale nor boundary are changed afterwards: the area may differ from the chart's own.
/// Throws NumericalFailure, for charts with holes too, and Cancelled.
LpfbResult flatten_lpfb(const FlatteningProblem& problem, const LpfbOptions& options,
                        const Progress& progress);

/// The same with other angles (#boundary, radians) to stay near to. Those of a map without flips
/// give the map's seams their lengths back, where the angles on the surface cross the boundary.
LpfbResult flatten_lpfb(const FlatteningProblem& problem, const std::vector<double>& targets,
                        const LpfbOptions& options, const Progress& progress);

/// The closed polygon near `points` with edge i of length lengths[i], from point i to i + 1, by
/// Newton steps on the lengths, each the shortest move of the points. Nothing where the steps do
/// not converge.
std::optional<std::vector<Vec2>> restore_lengths(std::vector<Vec2> points,
                                                 const std::vector<double>& lengths,
                                                 const Progress& progress);

/// The map near `uv` (#v) with boundary edges of their lengths on the surface, around holes too:
/// the boundary's displacement is harmonic inside. It may have flips. Nothing where there is no
/// such boundary.
std::optional<std::vector<Vec2>> restore_seam_lengths(const FlatteningProblem& problem,
                                                      const std::vector<Vec2>& uv,
                                                      const Progress& progress);

} // namespace devseg::flatten
