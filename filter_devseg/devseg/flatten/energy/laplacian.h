// The cotangent Laplacian of a chart, factorized once for many maps.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/SparseCholesky>

#include "devseg/flatten/energy/distortion.h"

namespace devseg::flatten {

/// ½ Σ cot (δᵢ − δⱼ)² / Σ A over the edges of the faces as they are in space, made definite by a
/// shift far below its own size. At an isometry, the symmetric Dirichlet energy has it as Hessian,
/// up to a factor and the rotations.
class Laplacian {
public:
    /// Vertices that are marked in `fixed` (#v, may be empty) hardly move in solutions. Throws
    /// NumericalFailure.
    explicit Laplacian(const FlatteningProblem& problem,
                       const std::vector<std::uint8_t>& fixed = {});

    /// The positions (#v by 2) with the given product with the Laplacian.
    Positions solve(const Positions& rhs) const;

private:
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

} // namespace devseg::flatten
