#include "devseg/mesh/mesh.h"

#include <utility>

namespace devseg::mesh {

namespace {

// A face without area has no normal of its own. It takes the area-weighted mean of its
// neighbours', spread over several rounds so that slivers beside slivers get one as well.
void spread_normals(Mesh& mesh, std::vector<Index> missing) {
    while (!missing.empty()) {
        std::vector<std::pair<Index, Vec3>> found;
        std::vector<Index> still_missing;
        for (const Face f : missing) {
            Vec3 sum = Vec3::Zero();
            for (const HalfEdge h : half_edges_of(f))
                if (mesh.twin[h] >= 0)
                    sum += mesh.face_normals[mesh.across(h)];
            if (sum.squaredNorm() > 0.0)
                found.emplace_back(f, sum.normalized());
            else
                still_missing.push_back(f);
        }
        if (found.empty())
            break;
        for (const auto& [f, normal] : found)
            mesh.face_normals[f] = normal;
        missing = std::move(still_missing);
    }
    for (const Face f : missing)
        mesh.face_normals[f] = Vec3::UnitZ(); // a component without any area: any direction
}

} // namespace

void compute_face_geometry(Mesh& mesh) {
    const std::size_t count = mesh.faces.size();
    mesh.face_areas.resize(count);
    mesh.face_normals.resize(count);
    mesh.face_centers.resize(count);
    mesh.total_area = 0.0;
    std::vector<Index> without_normal;
    for (const Face f : mesh.all_faces()) {
        const auto [v, w, u] = mesh.faces[f];
        const Vec3& a = mesh.points[v];
        const Vec3& b = mesh.points[w];
        const Vec3& c = mesh.points[u];
        const Vec3 normal = (b - a).cross(c - a);
        const double length = normal.norm();
        mesh.face_areas[f] = 0.5 * length;
        mesh.total_area += 0.5 * length;
        mesh.face_centers[f] = (a + b + c) / 3.0;
        if (length > 0.0) {
            mesh.face_normals[f] = normal / length;
        } else {
            mesh.face_normals[f].setZero();
            without_normal.push_back(f);
        }
    }
    spread_normals(mesh, std::move(without_normal));
    mesh.box.setEmpty();
    for (const Vec3& p : mesh.points)
        mesh.box.extend(p);
}

} // namespace devseg::mesh
