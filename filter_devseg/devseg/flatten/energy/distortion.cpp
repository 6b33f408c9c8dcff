// References
//   J. Smith, S. Schaefer: Bijective Parameterization with Free Boundaries. ACM Transactions on
//   Graphics 34(4), 2015. doi:10.1145/2766947 (the energy; the step bound of section 3.3)
//   [SGK19] B. Smith, F. de Goes, T. Kim: Analytic Eigensystems for Isotropic Distortion Energies.
//   ACM Transactions on Graphics 38(1), 2019. doi:10.1145/3241041
#include "devseg/flatten/energy/distortion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

// Smallest t > 0 with a t² + b t + c = 0; infinite if there is none. c > 0.
double first_root(double a, double b, double c) {
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0)
        return infinite;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    double best = infinite;
    for (const double root : {a != 0.0 ? q / a : infinite, q != 0.0 ? c / q : infinite})
        if (root > 0.0)
            best = std::min(best, root);
    return best;
}

} // namespace

double distortion(const FlatteningProblem& problem, const Positions& x) {
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian(problem, x, f);
        const double det = j.determinant();
        if (!(det > 0.0))
            return infinite;
        // |J⁻¹|² = |J|² / det² in the plane.
        sum += problem.area[f] * j.squaredNorm() * (1.0 + 1.0 / (det * det));
    }
    return sum / (4.0 * problem.total_area);
}

Positions distortion_gradient(const FlatteningProblem& problem, const Positions& x) {
    Positions gradient = Positions::Zero(x.rows(), 2);
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian(problem, x, f);
        const double det = j.determinant();
        Eigen::Matrix2d cofactor; // ∂ det / ∂ J
        cofactor << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);
        const Eigen::Matrix2d stress =
            (1.0 + 1.0 / (det * det)) * j - (j.squaredNorm() / (det * det * det)) * cofactor;
        const Eigen::Matrix2d force = (problem.area[f] / (2.0 * problem.total_area)) * stress *
                                      problem.inverse[f].transpose();
        const Triangle& t = problem.faces[f];
        gradient.row(t[1]) += force.col(0).transpose();
        gradient.row(t[2]) += force.col(1).transpose();
        gradient.row(t[0]) -= (force.col(0) + force.col(1)).transpose();
    }
    return gradient;
}

Eigen::Matrix4d projected_hessian(const Eigen::Matrix2d& j) {
    const Eigen::JacobiSVD<Eigen::Matrix2d> svd(j, Eigen::ComputeFullU | Eigen::ComputeFullV);
    // J = U Σ Vᵀ with det J > 0, so that U and V are both rotations or both reflections: the modes
    // below are products of the two, in which the reflections cancel up to signs.
    const Eigen::Matrix2d& u = svd.matrixU();
    const Eigen::Matrix2d& v = svd.matrixV();
    const double s1 = svd.singularValues()[0];
    const double s2 = svd.singularValues()[1];
    const double cube1 = s1 * s1 * s1;
    const double cube2 = s2 * s2 * s2;
    // [SGK19, section 4]: two scaling modes, the twist and the flip.
    const double scale1 = 0.5 * (1.0 + 3.0 / (cube1 * s1));
    const double scale2 = 0.5 * (1.0 + 3.0 / (cube2 * s2));
    const double twist = 0.5 * (s1 + s2 - 1.0 / cube1 - 1.0 / cube2) / (s1 + s2);
    const double flip = 0.5 * (1.0 + (s1 * s1 + s1 * s2 + s2 * s2) / (cube1 * cube2));
    Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();
    const auto add = [&](double eigenvalue, const Eigen::Matrix2d& mode) {
        if (eigenvalue <= 0.0)
            return;
        const Eigen::Matrix2d m = u * mode * v.transpose();
        const Eigen::Vector4d column(m(0, 0), m(1, 0), m(0, 1), m(1, 1));
        hessian += eigenvalue * column * column.transpose();
    };
    const double half = std::sqrt(0.5);
    Eigen::Matrix2d mode;
    add(scale1, (mode << 1.0, 0.0, 0.0, 0.0).finished());
    add(scale2, (mode << 0.0, 0.0, 0.0, 1.0).finished());
    add(twist, (mode << 0.0, -half, half, 0.0).finished());
    add(flip, (mode << 0.0, half, half, 0.0).finished());
    return hessian;
}

double collapse_step(const FlatteningProblem& problem, const Positions& x, const Positions& d) {
    double step = infinite;
    for (const Triangle& t : problem.faces) {
        const Eigen::Vector2d p = (x.row(t[1]) - x.row(t[0])).transpose();
        const Eigen::Vector2d q = (x.row(t[2]) - x.row(t[0])).transpose();
        const Eigen::Vector2d dp = (d.row(t[1]) - d.row(t[0])).transpose();
        const Eigen::Vector2d dq = (d.row(t[2]) - d.row(t[0])).transpose();
        step = std::min(step,
                        first_root(plane::cross(dp, dq), plane::cross(p, dq) + plane::cross(dp, q),
                                   plane::cross(p, q)));
    }
    return step;
}

} // namespace devseg::flatten
