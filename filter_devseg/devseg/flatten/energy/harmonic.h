// Harmonic maps: inner vertices in balance between their neighbours, with the boundary where it is.
//
// References
//   [Flo03] M. S. Floater: Mean Value Coordinates. Computer Aided Geometric Design 20(1), 2003.
//           doi:10.1016/S0167-8396(03)00002-5
#pragma once

#include <functional>
#include <vector>

#include <Eigen/SparseCholesky>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

class HarmonicMap {
public:
    /// What an edge weighs, for the cotangent of the angle opposite to it in one of its faces.
    using Weight = std::function<double(double cotangent)>;

    /// Moves the inner vertices of uv (#v); those on the boundary stay. `problem` must outlive it.
    /// Throws NumericalFailure where the equations cannot be solved.
    HarmonicMap(
        const FlatteningProblem& problem, std::vector<Vec2>& uv,
        const Weight& weight = [](double cotangent) { return cotangent; });

    /// Puts the inner vertices of flipped faces at mean-value weights [Flo03]. Returns the number
    /// of these vertices, 0 if nothing is done.
    Index mend(std::vector<Vec2>& uv) const;

private:
    const FlatteningProblem& problem_;
    std::vector<Index> slot_; // #v: number of the unknown, −1 on the boundary
    Index unknowns_ = 0;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

} // namespace devseg::flatten
