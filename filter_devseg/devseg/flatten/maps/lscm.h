// Least squares conformal maps.
#pragma once

#include <vector>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// The map with the least conformal energy ½ Σ A (σ₁ − σ₂)² with two far boundary vertices pinned
/// at their distance in the boundary's plane; scaled so that its area is the chart's own.
/// Angles are kept as well as they can be; triangles may flip on strongly curved charts. Throws
/// NumericalFailure when the linear system cannot be solved.
std::vector<Vec2> flatten_lscm(const FlatteningProblem& problem);

/// ½ Σ A (σ₁ − σ₂)² of any map: the energy that flatten_lscm minimises. uv is #v.
double conformal_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

} // namespace devseg::flatten
