// Newton's method with projected Hessians, for maps that are far from isometric.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "devseg/flatten/energy/distortion.h"

namespace devseg::flatten {

/// Of a face, by its number and det J: the second derivative, at least 0, of a further term of its
/// energy; as all of ψ it is weighted by the face's area.
using AreaCurvature = std::function<double(std::size_t face, double det)>;

/// Directions −H⁻¹ g for the symmetric Dirichlet energy, with H the sum of the faces' projected
/// Hessians. Each direction costs a sparse factorization; the order of elimination is found once.
class ProjectedNewton {
public:
    /// Vertices that are marked in `fixed` (#v, may be empty) stay where they are.
    /// `boundary_stiffness` k adds k Σ (length − own length)² / Σ A over the boundary edges.
    ProjectedNewton(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed,
                    AreaCurvature area_curvature = {}, double boundary_stiffness = 0.0);
    ~ProjectedNewton();

    /// A descent direction (#v by 2); throws NumericalFailure where H cannot be factorized.
    Positions direction(const Positions& x, const Positions& gradient);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace devseg::flatten
