#include "unit/mesh_edits.h"

#include <numeric>

namespace devseg::shapes {

Vec3 Random::direction() {
    while (true) {
        const Vec3 p(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0));
        if (p.norm() > 0.1 && p.norm() < 1.0)
            return p.normalized();
    }
}

mesh::RawMesh join(const mesh::RawMesh& a, const mesh::RawMesh& b) {
    mesh::RawMesh mesh = a;
    const Index offset = static_cast<Index>(a.points.size());
    mesh.points.insert(mesh.points.end(), b.points.begin(), b.points.end());
    for (const Triangle& t : b.faces)
        mesh.faces.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    return mesh;
}

mesh::RawMesh moved(mesh::RawMesh mesh, double scale, const Vec3& offset) {
    for (Vec3& p : mesh.points)
        p = scale * p + offset;
    return mesh;
}

mesh::RawMesh turned_over(mesh::RawMesh mesh) {
    for (Triangle& t : mesh.faces)
        std::swap(t[1], t[2]);
    return mesh;
}

mesh::RawMesh with_random_orientations(mesh::RawMesh mesh, std::uint32_t seed) {
    Random random(seed);
    for (Triangle& t : mesh.faces)
        if (random.below(2) == 1)
            std::swap(t[1], t[2]);
    return mesh;
}

mesh::RawMesh with_noise(mesh::RawMesh mesh, double amplitude, std::uint32_t seed) {
    Random random(seed);
    for (Vec3& p : mesh.points)
        for (int axis = 0; axis < 3; ++axis)
            p[axis] += random.uniform(-amplitude, amplitude);
    return mesh;
}

mesh::RawMesh with_face_order(const mesh::RawMesh& mesh, const std::vector<Index>& order) {
    mesh::RawMesh result;
    result.points = mesh.points;
    for (const Index f : order)
        result.faces.push_back(mesh.faces[f]);
    return result;
}

std::vector<Index> random_order(std::size_t count, std::uint32_t seed) {
    std::vector<Index> order(count);
    std::iota(order.begin(), order.end(), 0);
    Random(seed).shuffle(order);
    return order;
}

} // namespace devseg::shapes
