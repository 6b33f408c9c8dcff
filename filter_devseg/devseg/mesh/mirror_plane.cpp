#include "devseg/mesh/mirror_plane.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include "devseg/base/parallel.h"
#include "devseg/mesh/surface_search.h"

namespace devseg::mesh {

namespace {

struct Tuning {
    Index plane_samples = 1500;       // points; a sixth of them while planes are compared
    std::size_t promising_planes = 3; // that are fitted to all samples
    int fitting_rounds = 30;
    double trusted_points = 0.8; // the nearest, that a plane is fitted to: the rest may differ
};
constexpr Tuning tuning;

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
    for (const Vertex v : vertices) {
        const Vec3 image = plane.reflect(mesh.points[v]);
        const Index near = search.vertex(image, reflect_direction(plane, search.normal(v)),
                                         [](Index) { return true; });
        if (near < 0)
            continue;
        const Vec3 q = search.on_faces(image, near, [](Index) { return true; }).second;
        pairs.push_back({mesh.points[v], q, (q - image).norm()});
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
    for (const Face f : mesh.all_faces())
        center += mesh.face_areas[f] / mesh.total_area * mesh.face_centers[f];
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Face f : mesh.all_faces()) {
        const Vec3 d = mesh.face_centers[f] - center;
        spread += mesh.face_areas[f] * d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    std::vector<MirrorPlane> planes;
    const Eigen::Matrix3d& axes = solver.eigenvectors();
    std::vector<Vec3> normals;
    for (int k = 0; k < 3; ++k)
        for (const Vec3& normal :
             {Vec3(axes.col(k)), Vec3((axes.col(k) + axes.col((k + 1) % 3)).normalized()),
              Vec3((axes.col(k) - axes.col((k + 1) % 3)).normalized())})
            normals.push_back(normal);
    for (const Vec3& normal : normals)
        for (const Vec3& point : {center, Vec3(mesh.box.center())})
            planes.push_back({normal, normal.dot(point), 0.0});
    return planes;
}

class PlaneFinder {
public:
    PlaneFinder(const Mesh& mesh, Progress& progress)
        : mesh_(mesh), progress_(progress), search_(mesh), diagonal_(mesh.diagonal()) {
        take_samples(tuning.plane_samples);
    }

    void take_samples(Index count) {
        vertices_.clear();
        const Index stride = std::max<Index>(1, mesh_.vertex_count() / count);
        for (Index v = 0; v < mesh_.vertex_count(); v += stride)
            if (search_.leaving(v) >= 0)
                vertices_.push_back(v);
    }

    // The best planes on the ways from guesses, within the tolerance.
    std::vector<MirrorPlane> follow_all(const std::vector<MirrorPlane>& guesses,
                                        double tolerance) const {
        std::vector<std::optional<MirrorPlane>> found(guesses.size());
        parallel_for(
            static_cast<int>(guesses.size()),
            [&](int i) {
                const auto k = static_cast<std::size_t>(i);
                found[k] = follow(guesses[k], tolerance);
            },
            progress_);
        std::vector<MirrorPlane> planes;
        for (const auto& plane : found)
            if (plane)
                planes.push_back(*plane);
        std::stable_sort(planes.begin(), planes.end(),
                         [&](const auto& a, const auto& b) { return is_better(a, b); });
        return planes;
    }

private:
    // The best plane on the way from a guess.
    std::optional<MirrorPlane> follow(MirrorPlane plane, double tolerance) const {
        std::optional<MirrorPlane> best;
        for (int round = 0; round < tuning.fitting_rounds; ++round) {
            progress_.check();
            const std::vector<Pairing> pairs = pair_up(mesh_, search_, vertices_, plane);
            const auto count =
                static_cast<std::size_t>(tuning.trusted_points * static_cast<double>(pairs.size()));
            if (count < 3)
                break;
            plane.deviation = pairs[pairs.size() * 9 / 10].distance / diagonal_;
            if (pairs.size() < vertices_.size() * 9 / 10)
                plane.deviation = 1.0;
            if (plane.deviation <= tolerance && (!best || is_better(plane, *best)))
                best = plane;
            const MirrorPlane next = fit_plane(pairs, count);
            const bool is_settled = (next.normal - plane.normal).norm() < 1e-5 &&
                                    std::abs(next.offset - plane.offset) < 1e-5 * diagonal_;
            // A guess that does not come near is not followed to its end.
            if (is_settled || (round == 5 && plane.deviation > 4.0 * tolerance))
                break;
            plane.normal = next.normal;
            plane.offset = next.offset;
        }
        return best;
    }

    // A flat model is near to its mirror image front to back: how far it reaches to both sides of
    // the plane is compared with.
    bool is_better(const MirrorPlane& plane, const MirrorPlane& other) const {
        return plane.deviation / extent(plane) < other.deviation / extent(other);
    }

    double extent(const MirrorPlane& plane) const {
        double farthest = 0.0;
        for (const Vertex v : vertices_)
            farthest = std::max(farthest, std::abs(plane.height(mesh_.points[v])));
        return farthest;
    }

    const Mesh& mesh_;
    Progress& progress_;
    const SurfaceSearch search_;
    std::vector<Index> vertices_; // samples
    const double diagonal_;
};

} // namespace

std::optional<MirrorPlane> find_mirror_plane(const Mesh& mesh, double tolerance,
                                             Progress& progress) {
    if (!(mesh.total_area > 0.0))
        return std::nullopt;
    PlaneFinder finder(mesh, progress);
    finder.take_samples(tuning.plane_samples / 6);
    std::vector<MirrorPlane> planes = finder.follow_all(first_guesses(mesh), 2.0 * tolerance);
    if (planes.size() > tuning.promising_planes)
        planes.resize(tuning.promising_planes);
    finder.take_samples(tuning.plane_samples);
    planes = finder.follow_all(planes, tolerance);
    if (planes.empty())
        return std::nullopt;
    return planes.front();
}

} // namespace devseg::mesh
