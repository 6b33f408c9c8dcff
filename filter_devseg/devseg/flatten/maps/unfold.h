// The exact development of a chart that is developable.
#pragma once

#include <optional>
#include <vector>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Lays the faces of a chart into the plane one by one, each beside one that lies there already, as
/// paper unfolds. Around holes the sheet must close. Returns the positions (#v, internal units)
/// where that is an isometry: every edge keeps its length to within `tolerance` times the root of
/// the chart's area, and no face is turned over. Nothing for charts that are not developable.
std::optional<std::vector<Vec2>> unfold(const FlatteningProblem& problem, double tolerance = 1e-6);

/// Radians: what deformations leave at most around an inner vertex.
constexpr double exact_angle = 1e-6;

/// Largest difference of the angles around an inner vertex from 2π, radians: small faces unfold to
/// within a length although theirs are wrong.
double largest_defect(const FlatteningProblem& problem);

} // namespace devseg::flatten
