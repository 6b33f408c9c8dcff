#include "devseg/mesh/canonical_frame.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace devseg::mesh {

namespace {

constexpr double golden_ratio = 0.61803398874989485; // multiples of it spread evenly over 0 … 1
constexpr double unevenness = 0.2;
constexpr double area_loss = 0.01;
constexpr double grid = 0x1p-24; // units of the frame

double weight(const Mesh& mesh, Face f) {
    const double spread = golden_ratio * f - std::floor(golden_ratio * f);
    return mesh.face_areas[f] * (1.0 + unevenness * (spread - 0.5));
}

} // namespace

CanonicalFrame canonical_frame(const Mesh& mesh, const Progress& progress) {
    CanonicalFrame frame;
    double total = 0.0;
    for (const Face f : mesh.all_faces()) {
        frame.center += weight(mesh, f) * mesh.face_centers[f];
        total += weight(mesh, f);
    }
    if (!(total > 0.0))
        return {};
    frame.center /= total;
    frame.unit = std::sqrt(mesh.total_area);
    progress.check();
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Face f : mesh.all_faces()) {
        const Vec3 d = mesh.face_centers[f] - frame.center;
        spread += weight(mesh, f) * d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    for (int k = 0; k < 2; ++k) {
        progress.check();
        const Vec3 axis = solver.eigenvectors().col(2 - k);
        double third = 0.0;
        for (const Face f : mesh.all_faces()) {
            const double d = axis.dot(mesh.face_centers[f] - frame.center);
            third += weight(mesh, f) * d * d * d;
        }
        frame.axes.row(k) = third < 0.0 ? -axis : axis;
    }
    frame.axes.row(2) = frame.axes.row(0).cross(frame.axes.row(1));
    frame.is_identity = false;
    if (!(std::abs(in_frame(mesh, frame, progress).total_area - 1.0) < area_loss))
        return {};
    return frame;
}

Vec3 CanonicalFrame::to_frame(const Vec3& p) const {
    if (is_identity)
        return p;
    const Vec3 local = axes * (p - center) / unit;
    return (local / grid).array().round() * grid;
}

Mesh in_frame(const Mesh& mesh, const CanonicalFrame& frame, const Progress& progress) {
    progress.check();
    Mesh result = mesh;
    result.unit_length *= frame.unit;
    for (Vec3& p : result.points)
        p = frame.to_frame(p);
    progress.check();
    compute_face_geometry(result);
    return result;
}

} // namespace devseg::mesh
