// The symmetric Dirichlet energy with its derivatives, per face and for a whole map.
#pragma once

#include <Eigen/Core>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

using Positions = Eigen::MatrixX2d; // #v by 2

/// Jacobian of the map from the rest triangle of face f to the plane.
inline Eigen::Matrix2d jacobian(const FlatteningProblem& problem, const Positions& x,
                                std::size_t f) {
    const Triangle& t = problem.faces[f];
    Eigen::Matrix2d edges;
    edges.col(0) = (x.row(t[1]) - x.row(t[0])).transpose();
    edges.col(1) = (x.row(t[2]) - x.row(t[0])).transpose();
    return edges * problem.inverse[f];
}

/// Σ A (σ₁² + σ₂² + σ₁⁻² + σ₂⁻²) / (4 Σ A); infinite where a face is flipped or has no area.
double distortion(const FlatteningProblem& problem, const Positions& x);

/// Its gradient, #v by 2.
Positions distortion_gradient(const FlatteningProblem& problem, const Positions& x);

/// Hessian of one face's density ψ = (|J|² + |J⁻¹|²) / 4 with respect to J (column by column), with
/// negative eigenvalues set to zero.
Eigen::Matrix4d projected_hessian(const Eigen::Matrix2d& jacobian);

/// The step along direction d at which the first triangle has no area left.
double collapse_step(const FlatteningProblem& problem, const Positions& x, const Positions& d);

} // namespace devseg::flatten
