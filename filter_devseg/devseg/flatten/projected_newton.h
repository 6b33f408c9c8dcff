// Newton's method with projected Hessians, for maps that are far from isometric.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "devseg/flatten/distortion.h"

namespace devseg {

/// Directions −H⁻¹ g for the symmetric Dirichlet energy, with H the sum of the faces' projected
/// Hessians. Each direction costs a sparse factorization; the order of elimination is found once.
class ProjectedNewton {
public:
    /// Vertices that are marked in `fixed` (#v, may be empty) stay where they are.
    /// `area_curvature`, if given, is the second derivative, at least 0, of a further term of each
    /// face by det J; as all of ψ it is weighted by the face's area.
    ProjectedNewton(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed,
                    std::function<double(double det)> area_curvature = {});
    ~ProjectedNewton();

    /// A descent direction (#v by 2); throws NumericalFailure where H cannot be factorized.
    Positions direction(const Positions& x, const Positions& gradient);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace devseg
