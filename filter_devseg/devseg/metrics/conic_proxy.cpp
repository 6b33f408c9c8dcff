#include "devseg/metrics/conic_proxy.h"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace devseg::metrics {

namespace {
// Normals whose spread is below this (in radians squared) come from a plane up to rounding: the
// covariance then says nothing about an axis.
constexpr double planar_variance = 1e-10;
} // namespace

ConicProxy fit_conic(const NormalMoments& moments) {
    ConicProxy proxy;
    if (!(moments.area > 0.0)) {
        if (moments.first.squaredNorm() > 0.0)
            proxy.axis = moments.first.normalized();
        return proxy;
    }
    const Vec3 mean = moments.first / moments.area;
    const Eigen::Matrix3d covariance = moments.second / moments.area - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const double spread = solver.eigenvalues().maxCoeff();
    if (spread < planar_variance && mean.squaredNorm() > 0.0) {
        proxy.axis = mean.normalized();
    } else {
        proxy.axis = solver.eigenvectors().col(0).normalized();
        // The sign is free; fix it, so that equal charts get equal proxies.
        Eigen::Index largest = 0;
        proxy.axis.cwiseAbs().maxCoeff(&largest);
        if (proxy.axis[largest] < 0.0)
            proxy.axis = -proxy.axis;
    }
    proxy.cos_angle = std::clamp(proxy.axis.dot(mean), -1.0, 1.0);
    return proxy;
}

std::vector<ConicProxy> fit_conics(const Mesh& mesh, const std::vector<Index>& chart, Index count) {
    std::vector<NormalMoments> moments(at(count));
    for (const Face f : mesh.all_faces())
        if (chart[f] >= 0)
            moments[chart[f]].add(mesh.face_areas[f], mesh.face_normals[f]);
    std::vector<ConicProxy> proxies;
    for (const NormalMoments& m : moments)
        proxies.push_back(fit_conic(m));
    return proxies;
}

} // namespace devseg::metrics
