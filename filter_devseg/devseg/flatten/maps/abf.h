// Angle based flattening: the angles of a flat triangulation that are nearest to the chart's own,
// then coordinates from the angles.
#pragma once

#include <vector>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

struct AbfOptions {
    int max_iterations = 10;                // Newton steps at most
    double tolerance = 1e-4;                // radians (0.006°); stop when no angle moves by more
    double min_angle = 0.05235987755982988; // radians (3°); smaller angles start from here
    double max_angle = 3.0543261909900763;  // radians (175°); larger angles start from here
};

struct AbfResult {
    std::vector<Vec2> uv;   // #v, with the chart's own area
    bool converged = false; // if not, the map is the nearest to angles that do not quite fit
    int iterations = 0;
    double residual = 0.0; // largest violation of a constraint, in radians (wheels: of logarithms)
    double energy = 0.0;   // Σ (α − β)² / β² over all angles [SLMB05, equation 1]
    Index flips = 0;
};

/// ABF++: minimises Σ (α − β)² / β² over the angles α of flat triangulations, where β are the
/// chart's angles, scaled to a full turn around inner vertices. Throws NumericalFailure when the
/// angles or the coordinates cannot be solved for, Cancelled.
AbfResult flatten_abf(const FlatteningProblem& problem, const AbfOptions& options,
                      const Progress& progress);

/// The optimization problem of ABF++. Angle 3 f + c is at corner c of face f. Constraints in their
/// order, inner vertices in ascending order:
///   #f      the angles of a face add up to π,
///   #inner  the angles around a vertex add up to 2π,
///   #inner  the edges of a wheel close: Σ log sin α₊ = Σ log sin α₋, with α₊ and α₋ the next and
///           the previous angle of each face around the vertex.
/// `problem` must outlive it.
class AngleSystem {
public:
    AngleSystem(const FlatteningProblem& problem, const AbfOptions& options);

    /// A Newton step: the change of the angles, and the multipliers of all constraints after it.
    struct Step {
        Eigen::VectorXd angles;      // 3 #f
        Eigen::VectorXd multipliers; // #f + 2 #inner
    };

    const Eigen::VectorXd& targets() const { return target_; } // 3 #f, radians: β
    Eigen::VectorXd start() const;                             // 3 #f, radians
    Eigen::VectorXd constraints(const Eigen::VectorXd& angles) const;
    double energy(const Eigen::VectorXd& angles) const;
    /// Solves the reduced system, two unknowns for each inner vertex. Throws NumericalFailure.
    Step newton_step(const Eigen::VectorXd& angles);
    /// For the steps after one that had to stop short of an angle's end: from now on, an angle that
    /// has shrunk far below its target is as stiff as if its size were the target.
    void stiffen(const Eigen::VectorXd& angles);

private:
    void order_unknowns();
    void assemble(const Eigen::VectorXd& angles, Step& step);

    const FlatteningProblem& problem_;
    AbfOptions options_;
    Eigen::VectorXd target_;
    Eigen::VectorXd inverse_;  // 3 #f: inverse of the energy's Hessian, β² / 2 unless stiffened
    std::vector<Index> inner_; // #v: number among the inner vertices, −1 on the boundary
    std::vector<Index> place_; // #v: its first unknown in the reduced system, −1 on the boundary
    Index inner_count_ = 0;
    // M y = r for the multipliers y of the vertices' constraints, in the order of elimination.
    Eigen::SparseMatrix<double> matrix_; // lower half of M
    Eigen::VectorXd rhs_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
        solver_;
    bool analysed_ = false;
};

} // namespace devseg::flatten
