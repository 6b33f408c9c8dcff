// The conic proxy of D-Charts: a union of cones with one axis and one opening angle.
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include <vector>

#include <Eigen/Core>

#include "devseg/mesh/mesh.h"

namespace devseg::metrics {

/// ⟨N_C, θ_C⟩ of [JKS05, section 2.1.1]: all normals of the chart make the angle θ with the axis.
struct ConicProxy {
    Vec3 axis = Vec3::UnitZ(); // N_C, unit
    double cos_angle = 1.0;    // cos θ_C, in [−1, 1]

    /// Fitting error of a unit normal, [JKS05, equation 1]; between 0 and 4.
    double fitting_error(const Vec3& normal) const {
        const double difference = axis.dot(normal) - cos_angle;
        return difference * difference;
    }
};

/// Running sums over faces that determine a proxy: area, first and second moment of the normals.
struct NormalMoments {
    double area = 0.0;
    Vec3 first = Vec3::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

    void add(double face_area, const Vec3& normal) {
        area += face_area;
        first += face_area * normal;
        second += face_area * normal * normal.transpose();
    }
};

/// Minimises Σ A_t (N·n_t − cos θ)² over the axis and the angle [JKS05, equation 3]. For a fixed
/// axis the best cos θ is N·n̄; what remains is Nᵀ S N with S the covariance of the normals, so
/// the axis is the eigenvector of the smallest eigenvalue of S. No Newton solver is needed.
/// A chart with one normal only (a plane) takes this normal as its axis.
ConicProxy fit_conic(const NormalMoments& moments);

/// The proxy of each chart 0 … count − 1; faces labelled −1 belong to none.
std::vector<ConicProxy> fit_conics(const Mesh& mesh, const std::vector<Index>& chart, Index count);

} // namespace devseg::metrics
