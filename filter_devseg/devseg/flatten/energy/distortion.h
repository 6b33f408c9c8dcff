// The symmetric Dirichlet energy with its derivatives, per face and for a whole map; what its
// minimisers share: Newton's directions with projected Hessians, and the line search.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

using Positions = Eigen::MatrixX2d; // #v by 2

Positions positions_of(const std::vector<Vec2>& uv);
std::vector<Vec2> points_of(const Positions& x);

/// Sets the rows of vertices that are marked in `fixed` (#v, or empty) to zero.
void hold_fixed(const std::vector<std::uint8_t>& fixed, Positions& rows);

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

/// The same, and its gradient (#v by 2), which is left unfinished where the energy is infinite.
double distortion_with_gradient(const FlatteningProblem& problem, const Positions& x,
                                Positions& gradient);

/// Its gradient, #v by 2.
Positions distortion_gradient(const FlatteningProblem& problem, const Positions& x);

/// Hessian of one face's density ψ = (|J|² + |J⁻¹|²) / 4 with respect to J (column by column), with
/// negative eigenvalues set to zero.
Eigen::Matrix4d projected_hessian(const Eigen::Matrix2d& jacobian);

/// The step along direction d at which the first triangle has no area left. Where it is above
/// `limit`, any number above `limit`.
double collapse_step(const FlatteningProblem& problem, const Positions& x, const Positions& d,
                     double limit = infinite);

/// Goes from x along d, whose product with the gradient is `slope`, as far as pays: before the
/// first triangle would collapse, with the decrease of `energy` that Armijo's rule asks for. False
/// where there is no such step; x and `energy` then stay.
bool line_search(const FlatteningProblem& problem,
                 const std::function<double(const Positions&)>& value, const Positions& d,
                 double slope, Positions& x, double& energy);

/// Gradient of one face's density ψ with respect to J, column by column.
Eigen::Vector4d density_gradient(const Eigen::Matrix2d& jacobian);

/// Of a face, by its number and Jacobian: the Hessian of its density with respect to J (column by
/// column), without negative eigenvalues; it is weighted by the face's area.
using FaceHessian = std::function<Eigen::Matrix4d(std::size_t face, const Eigen::Matrix2d& j)>;

/// Directions −H⁻¹ g for the symmetric Dirichlet energy, or another one, with H the sum of the
/// faces' projected Hessians. Each direction costs a sparse factorization; the order of elimination
/// is found once.
class ProjectedNewton {
public:
    /// Vertices that are marked in `fixed` (#v, may be empty) stay where they are.
    /// `boundary_stiffness` k adds k Σ (length − own length)² / Σ A over the boundary edges.
    ProjectedNewton(const FlatteningProblem& problem, std::vector<std::uint8_t> fixed,
                    FaceHessian face_hessian = {}, double boundary_stiffness = 0.0);
    ~ProjectedNewton();

    /// Another stiffness, above 0 where it was.
    void set_boundary_stiffness(double stiffness);
    /// Adds to H, where the boundary is stiff, a block for each boundary vertex (`blocks` #v).
    void set_boundary_blocks(std::vector<Eigen::Matrix2d> blocks);

    /// A descent direction (#v by 2); throws NumericalFailure where H cannot be factorized.
    Positions direction(const Positions& x, const Positions& gradient);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace devseg::flatten
