// A valid start for methods that must not flip: the boundary on a circle, the inside in balance.
#pragma once

#include <vector>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Tutte's embedding: boundary vertices on a circle in proportion to their edge lengths, each inner
/// vertex at a positively weighted mean of its neighbours, so that no face flips in exact
/// arithmetic. Weights are cotangents, bounded from below and above; where rounding flips a face,
/// equal weights are tried as well. The caller checks the result with count_flips.
/// Throws NumericalFailure for charts with holes.
std::vector<Vec2> flatten_tutte(const FlatteningProblem& problem);

/// The least squares conformal map, or Tutte's embedding where that has flips. Throws
/// NumericalFailure.
std::vector<Vec2> simple_map(const FlatteningProblem& problem);

} // namespace devseg::flatten
