#include "devseg/develop/stiff_faces.h"

#include <algorithm>
#include <cmath>

#include "devseg/atlas/flat_cuts.h"
#include "devseg/develop/attempts.h"

namespace devseg::develop {

namespace {

struct Tuning {
    int rounds = 100; // of projections, where several planes share points
    // Of the diagonal: what points may be off their planes in the end, well below what exact holes
    // bear.
    double flat = 1e-12;
};
constexpr Tuning tuning;

struct Plane {
    Vec3 normal = Vec3::Zero();
    Vec3 centre = Vec3::Zero();
    std::vector<Index> points;

    double height(const Vec3& p) const { return normal.dot(p - centre); }
};

// The plane of the face, and the points of its triangles around holes.
Plane plane_of(const Mesh& mesh, const atlas::HoledFace& face, const std::vector<Index>& point_of) {
    std::vector<std::uint8_t> at_hole(mesh.points.size(), 0);
    for (const HalfEdge h : face.holes)
        at_hole[mesh.origin(h)] = 1;
    Plane plane;
    double area = 0.0;
    for (const Index f : face.faces) {
        plane.normal += mesh.face_areas[at(f)] * mesh.face_normals[at(f)];
        plane.centre += mesh.face_areas[at(f)] * mesh.face_centers[at(f)];
        area += mesh.face_areas[at(f)];
        const Triangle& t = mesh.faces[at(f)];
        if ((at_hole[at(t[0])] | at_hole[at(t[1])] | at_hole[at(t[2])]) != 0)
            for (const Index v : t)
                plane.points.push_back(point_of[at(v)]);
    }
    plane.normal.normalize();
    plane.centre /= area;
    std::sort(plane.points.begin(), plane.points.end());
    plane.points.erase(std::unique(plane.points.begin(), plane.points.end()), plane.points.end());
    return plane;
}

} // namespace

Mesh with_points(const Mesh& mesh, const std::vector<Vec3>& points) {
    Mesh moved = mesh;
    moved.points = points;
    mesh::compute_face_geometry(moved);
    return moved;
}

StiffFaces find_stiff_faces(const Mesh& mesh, const std::vector<Index>& point_of) {
    std::vector<Plane> planes;
    for (const atlas::HoledFace& face : atlas::flat_faces_with_holes(mesh))
        planes.push_back(plane_of(mesh, face, point_of));
    const std::size_t count = at(*std::max_element(point_of.begin(), point_of.end())) + 1;
    StiffFaces stiff{mesh.points, std::vector<std::uint8_t>(count, 0)};
    std::vector<Vec3> points(count, Vec3::Zero());
    for (std::size_t v = 0; v < point_of.size(); ++v)
        points[at(point_of[v])] = mesh.points[v];
    for (int round = 0; round < tuning.rounds; ++round)
        for (const Plane& plane : planes)
            for (const Index p : plane.points)
                points[at(p)] -= plane.height(points[at(p)]) * plane.normal;
    const double bound = tuning.flat * diagonal_of(mesh.points);
    for (const Plane& plane : planes)
        if (std::all_of(plane.points.begin(), plane.points.end(),
                        [&](Index p) { return std::abs(plane.height(points[at(p)])) <= bound; }))
            for (const Index p : plane.points)
                stiff.fixed[at(p)] = 1;
    for (std::size_t v = 0; v < point_of.size(); ++v)
        if (stiff.fixed[at(point_of[v])] != 0)
            stiff.points[v] = points[at(point_of[v])];
    return stiff;
}

} // namespace devseg::develop
