#include "devseg/plush/symmetry.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "devseg/cut/min_cut.h"
#include "devseg/mesh/surface_search.h"

namespace devseg {

namespace {

constexpr Index samples = 1500;   // points that are mirrored while a plane is fitted
constexpr int most_rounds = 30;   // of fitting
constexpr double trusted = 0.8;   // share of the points, the nearest, that a plane is fitted to
constexpr double cut_reach = 2.5; // of the mean edge: how far the middle line may leave the plane

Vec3 reflect_direction(const MirrorPlane& plane, const Vec3& d) {
    return d - 2.0 * plane.normal.dot(d) * plane.normal;
}

struct Pairing {
    Vec3 from;
    Vec3 to; // on the surface, near to the mirror image
    double distance = 0.0;
};

std::vector<Pairing> pair_up(const Mesh& mesh, const SurfaceSearch& search,
                             const std::vector<Index>& vertices, const MirrorPlane& plane) {
    std::vector<Pairing> pairs;
    for (const Index v : vertices) {
        const Vec3 image = plane.reflect(mesh.points[at(v)]);
        const Index near = search.vertex(image, reflect_direction(plane, search.normal(v)),
                                         [](Index) { return true; });
        if (near < 0)
            continue;
        const Vec3 q = search.on_faces(image, near, [](Index) { return true; }).second;
        pairs.push_back({mesh.points[at(v)], q, (q - image).norm()});
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pairing& a, const Pairing& b) { return a.distance < b.distance; });
    return pairs;
}

// The reflection that takes the first points of the pairs nearest to the second ones.
MirrorPlane fit_plane(const std::vector<Pairing>& pairs, std::size_t count) {
    Vec3 from = Vec3::Zero();
    Vec3 to = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) {
        from += pairs[i].from;
        to += pairs[i].to;
    }
    from /= static_cast<double>(count);
    to /= static_cast<double>(count);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < count; ++i)
        sum += (pairs[i].from - from) * (pairs[i].to - to).transpose();
    const Eigen::Matrix3d symmetric = sum + sum.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
    MirrorPlane plane;
    plane.normal = solver.eigenvectors().col(0);
    Eigen::Index axis = 0;
    plane.normal.cwiseAbs().maxCoeff(&axis);
    if (plane.normal[axis] < 0.0)
        plane.normal = -plane.normal;
    plane.offset = 0.5 * plane.normal.dot(from + to);
    return plane;
}

std::vector<MirrorPlane> first_guesses(const Mesh& mesh) {
    Vec3 center = Vec3::Zero();
    Eigen::AlignedBox3d box;
    for (Index f = 0; f < mesh.face_count(); ++f)
        center += mesh.face_areas[at(f)] / mesh.total_area * mesh.face_centers[at(f)];
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (Index f = 0; f < mesh.face_count(); ++f) {
        const Vec3 d = mesh.face_centers[at(f)] - center;
        spread += mesh.face_areas[at(f)] * d * d.transpose();
    }
    for (const Vec3& p : mesh.points)
        box.extend(p);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    std::vector<MirrorPlane> planes;
    for (int k = 0; k < 3; ++k)
        for (const Vec3& normal : {Vec3(Vec3::Unit(k)), Vec3(solver.eigenvectors().col(k))})
            for (const Vec3& point : {center, Vec3(box.center())})
                planes.push_back({normal, normal.dot(point), 0.0});
    return planes;
}

double mean_edge_length(const Mesh& mesh) {
    double sum = 0.0;
    for (Index h = 0; h < mesh.half_edge_count(); ++h)
        sum += mesh.edge_length(h);
    return sum / mesh.half_edge_count();
}

} // namespace

std::optional<MirrorPlane> find_mirror_plane(const Mesh& mesh, double tolerance,
                                             const Progress& progress) {
    const SurfaceSearch search(mesh);
    Eigen::AlignedBox3d box;
    std::vector<Index> vertices;
    const Index stride = std::max<Index>(1, mesh.vertex_count() / samples);
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        box.extend(mesh.points[at(v)]);
        if (v % stride == 0 && search.leaving(v) >= 0)
            vertices.push_back(v);
    }
    const double diagonal = box.diagonal().norm();
    const auto extent = [&](const MirrorPlane& plane) {
        double farthest = 0.0;
        for (const Index v : vertices)
            farthest = std::max(farthest, std::abs(plane.height(mesh.points[at(v)])));
        return farthest;
    };
    std::optional<MirrorPlane> best;
    for (MirrorPlane plane : first_guesses(mesh)) {
        for (int round = 0; round < most_rounds; ++round) {
            progress.check();
            const std::vector<Pairing> pairs = pair_up(mesh, search, vertices, plane);
            const auto count =
                static_cast<std::size_t>(trusted * static_cast<double>(pairs.size()));
            if (count < 3)
                break;
            plane.deviation = pairs[pairs.size() * 9 / 10].distance / diagonal;
            if (pairs.size() < vertices.size() * 9 / 10)
                plane.deviation = 1.0;
            // A flat model is near to its mirror image front to back: how far it reaches to both
            // sides of the plane is compared with.
            if (plane.deviation <= tolerance &&
                (!best || plane.deviation / extent(plane) < best->deviation / extent(*best)))
                best = plane;
            const MirrorPlane next = fit_plane(pairs, count);
            const bool is_settled = (next.normal - plane.normal).norm() < 1e-5 &&
                                    std::abs(next.offset - plane.offset) < 1e-5 * diagonal;
            // A guess that does not come near is not followed to its end.
            if (is_settled || (round == 5 && plane.deviation > 4.0 * tolerance))
                break;
            plane.normal = next.normal;
            plane.offset = next.offset;
        }
    }
    return best;
}

std::vector<std::uint8_t> sides_of(const Mesh& mesh, const MirrorPlane& plane) {
    const double reach = cut_reach * mean_edge_length(mesh);
    std::vector<CutSide> start(mesh.faces.size(), CutSide::open);
    for (std::size_t f = 0; f < start.size(); ++f) {
        const double height = plane.height(mesh.face_centers[f]);
        if (std::abs(height) > reach)
            start[f] = height < 0.0 ? CutSide::source : CutSide::sink;
    }
    MinCut cut(start);
    for (Index h = 0; h < mesh.half_edge_count(); ++h) {
        const Index twin = mesh.twin[at(h)];
        if (twin < h)
            continue;
        const double height = 0.5 *
                              (plane.height(mesh.points[at(mesh.origin(h))]) +
                               plane.height(mesh.points[at(mesh.target(h))])) /
                              reach;
        cut.link(h / 3, twin / 3, mesh.edge_length(h) * (1.0 + 4.0 * height * height));
    }
    const std::vector<CutSide> sides = cut.solve();
    std::vector<std::uint8_t> side(mesh.faces.size());
    for (std::size_t f = 0; f < side.size(); ++f)
        side[f] = sides[f] == CutSide::source ? 0 : 1;
    return side;
}

std::vector<Index> mirror_faces(const Mesh& mesh, const MirrorPlane& plane,
                                const std::vector<std::uint8_t>& side) {
    const SurfaceSearch search(mesh);
    std::vector<std::uint8_t> touches(2 * mesh.points.size(), 0); // vertex has faces on the side
    for (Index h = 0; h < mesh.half_edge_count(); ++h)
        touches[2 * at(mesh.origin(h)) + side[at(h / 3)]] = 1;
    std::vector<Index> image(mesh.faces.size());
    for (Index f = 0; f < mesh.face_count(); ++f) {
        const std::uint8_t other = side[at(f)] == 0 ? 1 : 0;
        const Vec3 p = plane.reflect(mesh.face_centers[at(f)]);
        const Vec3 n = reflect_direction(plane, mesh.face_normals[at(f)]);
        const auto on_side = [&](Index v) { return touches[2 * at(v) + other] != 0; };
        const Index v = search.vertex(p, n, on_side);
        image[at(f)] = f;
        if (v >= 0)
            image[at(f)] =
                search.on_faces(p, v, [&](Index g) { return side[at(g)] == other; }).first;
    }
    return image;
}

std::vector<Index> mirror_vertices(const Mesh& mesh, const MirrorPlane& plane) {
    const SurfaceSearch search(mesh);
    std::vector<Index> image(mesh.points.size(), -1);
    for (Index v = 0; v < mesh.vertex_count(); ++v)
        if (search.leaving(v) >= 0)
            image[at(v)] = search.vertex(plane.reflect(mesh.points[at(v)]),
                                         reflect_direction(plane, search.normal(v)),
                                         [](Index) { return true; });
    return image;
}

} // namespace devseg
