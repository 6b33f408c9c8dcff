// The angle sums of the inner vertices of charts as functions of the coordinates: values, gradients
// and the normal matrix of their Jacobian.
//
// References
//   [TTY15] K. Takahashi, T. Tachi, Y. Yamaguchi: Mesh Approximation for Generating Development
//   with
//           Creases and Slits. Journal for Geometry and Graphics 19(1), 2015, equations 1 and 4.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "devseg/mesh/mesh.h"

namespace devseg::develop {

using Normal = Eigen::SparseMatrix<double>;

class AngleConstraints {
public:
    /// One row for each of `vertices`, whose faces go all around. `point_of` (#V) holds the point
    /// that carries a vertex: vertices that must stay together share one.
    AngleConstraints(const Mesh& mesh, const std::vector<Index>& vertices,
                     const std::vector<Index>& point_of);

    Index count() const { return static_cast<Index>(begin_.size()) - 1; }

    /// Defects 2π − Σ θ of all rows, radians. `points` are indexed as in `point_of`.
    Eigen::VectorXd defects(const std::vector<Vec3>& points) const;

    /// The same for the rows that a changed point (1 in `changed`) belongs to; others stay.
    void update_defects(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& changed,
                        Eigen::VectorXd& defects) const;

    /// Takes the gradients at `points`.
    void linearise(const std::vector<Vec3>& points);

    /// J W Jᵀ + diagonal, lower triangle; J is the Jacobian of the angle sums in internal units and
    /// `mobility` (#points) the diagonal of W. Its pattern never changes.
    const Normal& normal_matrix(const std::vector<double>& mobility,
                                const Eigen::VectorXd& diagonal);

    /// W Jᵀ λ: a displacement for each of the points.
    std::vector<Vec3> displacement(const std::vector<double>& mobility,
                                   const Eigen::VectorXd& lambda) const;

    /// Points of row r: the centre first, then those around it.
    const Index* first_point(Index r) const { return point_.data() + begin_[r]; }
    const Index* last_point(Index r) const { return point_.data() + begin_[at(r) + 1]; }

private:
    double defect(Index r, const std::vector<Vec3>& points) const;
    void build_pattern(Index points);

    std::vector<Index> begin_; // rows + 1
    std::vector<Index> point_;
    std::vector<Vec3> gradient_;
    std::vector<Index> uses_begin_; // by point: its entries in the rows
    std::vector<Index> uses_;
    std::vector<Index> row_of_; // by entry
    std::vector<Index> slot_;   // by pair of uses of a point: place in the matrix
    std::vector<Index> diagonal_;
    Normal normal_;
};

} // namespace devseg::develop
