// Isometric maps without flips: minimisers of the symmetric Dirichlet energy.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/contacts.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

struct SymmetricDirichletOptions {
    int max_iterations = 300;         // quasi-Newton steps at most
    double relative_tolerance = 1e-6; // stop when ten steps gain less than this share of the energy
    // Stop as soon as the energy will clearly not fall below this.
    double give_up_energy = infinite;
    std::vector<std::uint8_t> fixed; // #v: 1 for vertices that stay; empty = all are free
};

struct SymmetricDirichletResult {
    std::vector<Vec2> uv; // #v, no face flipped
    double energy = 0.0; // Σ A (σ₁² + σ₂² + σ₁⁻² + σ₂⁻²) / (4 Σ A); 1 for an isometry
    int iterations = 0;
    bool converged = false;
};

/// Minimises the symmetric Dirichlet energy from a start without flips. The line search stops
/// before the first triangle would collapse, so every iterate is free of flips as well. Throws
/// NumericalFailure when the start has flips, Cancelled. A penalty on contacts may be added; the
/// energy in the result is then without it.
SymmetricDirichletResult minimise_symmetric_dirichlet(const FlatteningProblem& problem,
                                                      const std::vector<Vec2>& start,
                                                      const SymmetricDirichletOptions& options,
                                                      const Progress& progress,
                                                      const ContactPenalty& penalty = {});

/// The energy of any map; infinite where a face is flipped or has no area.
double symmetric_dirichlet_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

} // namespace devseg::flatten
