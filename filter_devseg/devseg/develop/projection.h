// One state of a deformation: points that move towards zero angle defects by damped steps of least
// length, which never turn, fold or collapse a face.
//
// References
//   see deform.h
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/SparseCholesky>

#include "devseg/develop/angle_constraints.h"

namespace devseg::develop {

class Projection {
public:
    /// `ease` (by point, 0 to 1): how easily it moves, compared with the others.
    Projection(const Mesh& mesh, const std::vector<Index>& point_of, std::vector<double> ease);

    /// Sets the vertices whose defects are to vanish, and the points (1 in `fixed`, or empty) that
    /// must not move for that.
    void constrain(const std::vector<Index>& vertices, const std::vector<std::uint8_t>& fixed);

    /// A round: one factorization, and steps with it as long as they gain much. Returns false where
    /// no step was of use.
    bool step();

    double residual() const {
        return defects_.size() > 0 ? defects_.lpNorm<Eigen::Infinity>() : 0.0;
    }
    const Eigen::VectorXd& defects() const { return defects_; }
    const std::vector<Vec3>& points() const { return points_; }

    /// Rounds, up to the last one, in which safeguards have shortened the steps of a point; the
    /// largest number of all points, and that of the points of row r.
    int longest_block() const;
    int block(Index r) const;
    /// Moves points that were blocked for so many rounds, and those around them, towards the middle
    /// of their neighbours.
    void relax_blocked(int rounds);

private:
    using Field = std::vector<Vec3>;
    void limit_tearing(Field& step) const;
    Eigen::VectorXd guarded(const Field& step, bool limit_defects, Field& moved);
    Index mark_bad(const Field& moved, const Eigen::VectorXd* after,
                   const std::vector<std::uint8_t>& changed, std::vector<std::uint8_t>& bad) const;
    bool face_spoilt(std::size_t f, const Field& moved) const;
    bool edge_folded(std::size_t e, const Field& moved) const;
    bool factorize();
    bool is_held() const;
    bool chord_steps();

    const Mesh* mesh_ = nullptr;
    std::vector<Index> point_of_;
    std::vector<Triangle> faces_; // by points
    struct Hinge {
        Face f, g; // faces
        double cosine;
    };
    std::vector<Hinge> hinges_;
    std::vector<std::array<Index, 2>> edges_; // by points
    std::vector<Index> valence_;
    std::vector<Vec3> start_normal_; // twice the area long
    Field points_;
    double edge_ = 1.0; // mean length: the unit of steps, with which damping has no unit
    std::vector<double> ease_;
    std::vector<double> mobility_;
    AngleConstraints constraints_;
    Eigen::SimplicialLDLT<Normal> solver_;
    Eigen::VectorXd defects_;
    double damping_ = 1e-2;
    bool fast_ = false;
    bool analysed_ = false;
    std::vector<int> block_; // by point
    bool count_blocks_ = false;
};

} // namespace devseg::develop
