#include "devseg/pattern/strain.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace devseg::pattern {

namespace {

// Thinner faces, as a share of their longest edge squared, have no shape to compare.
constexpr double no_area = 1e-12;

// Edges 0 → 1 and 0 → 2 of the face, laid into the plane.
Eigen::Matrix2d rest_edges(const Mesh& mesh, const Triangle& t) {
    const Vec3 p = mesh.points[t[1]] - mesh.points[t[0]];
    const Vec3 q = mesh.points[t[2]] - mesh.points[t[0]];
    const double base = p.norm();
    Eigen::Matrix2d edges;
    edges << base, p.dot(q) / base, 0.0, p.cross(q).norm() / base;
    return edges;
}

FaceStrain strain_of(const Eigen::Matrix2d& rest, const Eigen::Matrix2d& paper) {
    const double size = std::max(rest.squaredNorm(), paper.squaredNorm());
    FaceStrain strain;
    if (!(rest.determinant() > no_area * size) || !(std::abs(paper.determinant()) > no_area * size))
        return strain;
    const Eigen::Matrix2d map = paper * rest.inverse();
    // σ₁² + σ₂² and σ₁ σ₂ determine σ₁ ± σ₂.
    const double squares = map.squaredNorm();
    const double product = std::abs(map.determinant());
    const double sum = std::sqrt(squares + 2.0 * product);
    const double difference = std::sqrt(std::max(0.0, squares - 2.0 * product));
    strain.extension = std::max(0.0, 0.5 * (sum + difference) - 1.0);
    strain.compression = std::max(0.0, 1.0 - 0.5 * (sum - difference));
    return strain;
}

} // namespace

std::vector<FaceStrain> measure_strain(const Mesh& mesh, const std::vector<Vec2>& corners,
                                       double scale) {
    std::vector<FaceStrain> strain;
    for (const Face f : mesh.all_faces()) {
        Eigen::Matrix2d paper;
        paper.col(0) = scale * (corners[3 * f + 1] - corners[3 * f]);
        paper.col(1) = scale * (corners[3 * f + 2] - corners[3 * f]);
        strain.push_back(strain_of(rest_edges(mesh, mesh.faces[f]), paper));
    }
    return strain;
}

void measure_inside(const Mesh& mesh, const std::vector<Vec2>& corners,
                    const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                    const std::vector<FaceStrain>& strain, double fold_angle, double mm,
                    PatternPiece& piece) {
    double area = 0.0;
    double sum = 0.0;
    double worst = -1.0;
    for (const Face f : faces) {
        const FaceStrain& own = strain[f];
        area += mesh.face_areas[f];
        sum += mesh.face_areas[f] * own.largest();
        piece.strain.extension = std::max(piece.strain.extension, own.extension);
        piece.strain.compression = std::max(piece.strain.compression, own.compression);
        if (own.largest() > worst) {
            worst = own.largest();
            piece.strain.worst_face = f;
            piece.strain.worst_place =
                (corners[3 * f] + corners[3 * f + 1] + corners[3 * f + 2]) / 3.0;
        }
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            if (twin < h || seam[h] != 0)
                continue;
            const Vec3& normal = mesh.face_normals[f];
            const Vec3& other = mesh.face_normals[twin / 3];
            const double angle = std::atan2(normal.cross(other).norm(), normal.dot(other));
            if (!(angle > fold_angle))
                continue;
            const Vec3 across =
                mesh.points[mesh.origin(Mesh::previous(twin))] - mesh.points[mesh.origin(h)];
            piece.folds.push_back(
                {corners[h], corners[Mesh::next(h)], normal.dot(across) < 0.0 ? angle : -angle});
        }
    }
    if (!(area > 0.0))
        return;
    piece.strain.mean = sum / area;
    piece.strain.area_change = piece.area / (mm * mm * area) - 1.0;
}

} // namespace devseg::pattern
