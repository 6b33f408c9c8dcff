// Single faces that a map stretches far more than the rest.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Lowers the largest stretch where few faces stand out: the vertices around them are relaxed under
/// Σ A exp(s (ψ − 1)), with ψ the symmetric Dirichlet density, which shares the stretch out among
/// the faces nearby. No face flips; all other vertices stay. The map stays as it is if that would
/// cost more than a small part of its distortion. With `hold_boundary` the outline stays as well.
/// `twin` is 3 #f of the chart, uv is #v.
void relieve_peaks(const FlatteningProblem& problem, const std::vector<HalfEdge>& twin,
                   bool hold_boundary, std::vector<Vec2>& uv, const Progress& progress);

/// Brings the vertices around faces that stand out to the least symmetric Dirichlet energy, all
/// together, while the rest of the map stays: for maps that were relaxed vertex by vertex, which
/// leaves needles behind. No face flips, and the energy does not rise.
void settle_peaks(const FlatteningProblem& problem, const std::vector<HalfEdge>& twin,
                  std::vector<Vec2>& uv, const Progress& progress);

} // namespace devseg::flatten
