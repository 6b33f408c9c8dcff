// Giving the boundary of a map the lengths that it has on the surface.
//
// References
//   R. Goldenthal, D. Harmon, R. Fattal, M. Bercovier, E. Grinspun: Efficient Simulation of
//   Inextensible Cloth. ACM Transactions on Graphics 26(3), 2007. doi:10.1145/1276377.1276438 (the
//   fast projection)
#pragma once

#include <optional>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// The closed polygon near `points` with edge i of length lengths[i], from point i to i + 1, by
/// Newton steps on the lengths, each the shortest move of the points. Nothing where the steps do
/// not converge.
std::optional<std::vector<Vec2>> restore_lengths(std::vector<Vec2> points,
                                                 const std::vector<double>& lengths,
                                                 const Progress& progress);

/// The map near `uv` (#v) with boundary edges of their lengths on the surface: the boundary's
/// displacement is harmonic inside. It may have flips. Nothing where there is no such boundary.
std::optional<std::vector<Vec2>> restore_seam_lengths(const FlatteningProblem& problem,
                                                      const std::vector<Vec2>& uv,
                                                      const Progress& progress);

} // namespace devseg::flatten
