// References
//   K. Hormann, M. S. Floater: Mean value coordinates for arbitrary planar polygons. ACM
//   Transactions on Graphics 25(4), 2006: section 5, the weights without angles.
#include "devseg/pattern/inside.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

using Ring = std::vector<Vec2>;

// An outline before it was moved, and how far each of its points was.
struct MovedRing {
    Ring points;
    Ring moves;
};

MovedRing moved_ring(const PiecePath& path, const PaperMap& place, const CornerUv& uv) {
    MovedRing ring;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        ring.points.push_back(place(uv[path.half_edge[i]]));
        ring.moves.push_back(path.points[i] - ring.points.back());
    }
    return ring;
}

// The move at p: that of the outline on it, and a mean of all moves inside.
Vec2 interpolated(const std::vector<MovedRing>& rings, const Vec2& p) {
    Vec2 sum = Vec2::Zero();
    double weights = 0.0;
    for (const MovedRing& ring : rings)
        for (std::size_t i = 0; i < ring.points.size(); ++i) {
            const std::size_t j = (i + 1) % ring.points.size();
            const Vec2 a = ring.points[i] - p;
            const Vec2 b = ring.points[j] - p;
            const double r = a.norm();
            const double s = b.norm();
            if (r == 0.0)
                return ring.moves[i];
            const double area = plane::cross(a, b);
            const double dot = a.dot(b);
            if (area == 0.0 && dot < 0.0) // on the edge
                return (s * ring.moves[i] + r * ring.moves[j]) / (r + s);
            if (area == 0.0)
                continue;
            const double half_tangent = (r * s - dot) / area;
            sum += half_tangent * (ring.moves[i] / r + ring.moves[j] / s);
            weights += half_tangent * (1.0 / r + 1.0 / s);
        }
    return weights != 0.0 ? Vec2(sum / weights) : Vec2::Zero();
}

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
    if (!(rest.determinant() > vanishing * size) ||
        !(std::abs(paper.determinant()) > vanishing * size))
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

std::vector<Vec2> place_corners(const Mesh& mesh, const CornerUv& uv,
                                const std::vector<Index>& faces, const PatternPiece& piece) {
    std::vector<MovedRing> moved;
    bool any = false;
    for (Index i = 0; i < piece.path_count(); ++i) {
        moved.push_back(moved_ring(piece.path(i), piece.place, uv));
        for (const Vec2& move : moved.back().moves)
            any = any || move.norm() > no_extent * piece.box.sizes().norm();
    }
    // Corners at one vertex are mostly one place: the last one is remembered.
    std::vector<std::pair<Vec2, Vec2>> known; // before and after
    std::vector<Index> entry(any ? mesh.points.size() : 0, -1);
    std::vector<Vec2> corners;
    for (const Face f : faces)
        for (Index k = 0; k < 3; ++k) {
            const Vec2 p = piece.place(uv[3 * f + k]);
            if (!any) {
                corners.push_back(p);
                continue;
            }
            Index& last = entry[mesh.faces[f][k]];
            if (last < 0 || known[last].first != p) {
                last = static_cast<Index>(known.size());
                known.emplace_back(p, p + interpolated(moved, p));
            }
            corners.push_back(known[last].second);
        }
    return corners;
}

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

double fold_angle_at(const Mesh& mesh, HalfEdge h) {
    const HalfEdge twin = mesh.twin[h];
    if (twin < 0)
        return 0.0;
    const Vec3& normal = mesh.face_normals[face_of(h)];
    const Vec3& other = mesh.face_normals[face_of(twin)];
    const double angle = std::atan2(normal.cross(other).norm(), normal.dot(other));
    const Vec3 across = mesh.points[mesh.apex(twin)] - mesh.points[mesh.origin(h)];
    return normal.dot(across) < 0.0 ? angle : -angle;
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
            const double angle = fold_angle_at(mesh, h);
            if (std::abs(angle) > fold_angle)
                piece.folds.push_back({corners[h], corners[Mesh::next(h)], angle});
        }
    }
    if (!(area > 0.0))
        return;
    piece.strain.mean = sum / area;
    piece.strain.area_change = piece.area / (mm * mm * area) - 1.0;
}

} // namespace devseg::pattern
