// Newton's method with projected Hessians, for maps that are far from isometric.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "devseg/flatten/distortion.h"

namespace devseg {

/// Directions −H⁻¹ g for the symmetric Dirichlet energy, with H the sum of the faces' projected
/// Hessians. Each direction costs a sparse factorization; the order of elimination is found once.
class ProjectedNewton {
public:
    /// Vertices that are marked in `fixed` (#v, may be empty) stay where they are.
    ProjectedNewton(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed);
    ~ProjectedNewton();

    /// A descent direction (#v by 2); throws NumericalFailure where H cannot be factorized.
    Positions direction(const Positions& x, const Positions& gradient);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace devseg
