// Isometric maps without flips: minimisers of the symmetric Dirichlet energy, and of that energy
// with a penalty on contacts, which pushes parts of a chart apart that overlap in the plane.
//
// References
//   [SS15] J. Smith, S. Schaefer: Bijective Parameterization with Free Boundaries. ACM Transactions
//          on Graphics 34(4), 2015. doi:10.1145/2766947 (there a barrier that starts from a
//          one-to-one map; here a penalty that ends in one, because the start is better)
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/contacts.h"
#include "devseg/flatten/energy/distortion.h"

namespace devseg::flatten {

class Laplacian;

struct SymmetricDirichletOptions {
    int max_iterations = 300;         // quasi-Newton steps at most
    double relative_tolerance = 1e-6; // stop when ten steps gain less than this share of the energy
    // Stop as soon as the energy will clearly not fall below this.
    double give_up_energy = infinite;
    std::vector<std::uint8_t> fixed;      // #v: 1 for vertices that stay; empty = all are free
    const Laplacian* laplacian = nullptr; // of the problem, where there is one already
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
