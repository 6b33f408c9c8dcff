#include "unit/pattern_samples.h"

#include <cmath>

#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::samples {

void Cloth::add(const mesh::RawMesh& part, const Place& place) {
    const Index offset = static_cast<Index>(host_.geometry.points.size());
    host_.geometry.points.insert(host_.geometry.points.end(), part.points.begin(),
                                 part.points.end());
    for (const Triangle& t : part.faces) {
        host_.geometry.faces.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
        std::array<Vec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = part.points[t[k]];
        const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        host_.wedge_uv.push_back(
            {place(corners[0], middle), place(corners[1], middle), place(corners[2], middle)});
    }
}

Mesh Cloth::mesh() const {
    return mesh::gate_mesh(host_.geometry).mesh;
}

CornerUv Cloth::uv() const {
    const mesh::GatedMesh gated = mesh::gate_mesh(host_.geometry);
    CornerUv uv;
    for (const Face f : gated.mesh.all_faces())
        for (Index k = 0; k < 3; ++k)
            uv.push_back(host_.wedge_uv[gated.source_face[f]][gated.source_corner(f, k)]);
    return uv;
}

pattern::Pattern Cloth::pattern(const pattern::PatternOptions& options) const {
    Progress progress;
    return pattern::make_pattern(mesh(), uv(), options, progress);
}

Vec2 flat(const Vec3& p) {
    return p.head<2>();
}

Cloth two_pieces(double seam_x) {
    Cloth cloth;
    cloth.add(shapes::grid(8, 8, 80.0, 80.0), [seam_x](const Vec3& p, const Vec3& middle) {
        return Vec2(flat(p) + Vec2(middle.x() > seam_x ? 5.0 : 0.0, 0.0));
    });
    return cloth;
}

Cloth with_dart(double angle) {
    Cloth cloth;
    const double open = std::tan(angle * shapes::pi / 180.0);
    cloth.add(shapes::grid(8, 8, 80.0, 80.0), [open](const Vec3& p, const Vec3& middle) {
        // Everything above the slit, right of its tip, is sheared upwards.
        const double lift = middle.y() > 40.0 ? open * std::max(0.0, p.x() - 40.0) : 0.0;
        return Vec2(p.x(), p.y() + lift);
    });
    return cloth;
}

Cloth unfinished() {
    Cloth cloth = with_dart(6.0);
    cloth.add(shapes::with_noise(shapes::grid(8, 8, 80.0, 80.0), 2.0, 7),
              [](const Vec3& p, const Vec3& middle) {
                  const bool small = middle.x() > 70.0 && middle.y() > 70.0;
                  return Vec2(flat(p) + Vec2(small ? 105.0 : 100.0, 0.0));
              });
    cloth.add(shapes::helix_strip(30, 1.3, 20.0, 30.0, 0.5),
              [](const Vec3& p, const Vec3&) { return Vec2(flat(p) + Vec2(40.0, 160.0)); });
    return cloth;
}

Cloth nearly_equal() {
    Cloth cloth = with_dart(6.0);
    for (const double size : {30.0, 30.3})
        cloth.add(shapes::grid(3, 2, size, 20.0), [size](const Vec3& p, const Vec3&) {
            return Vec2(flat(p) + Vec2(200.0 * (size - 30.0) + 100.0, 120.0));
        });
    cloth.add(shapes::annulus(90, 1, 10.0, 30.0),
              [](const Vec3& p, const Vec3&) { return Vec2(flat(p) + Vec2(40.0, 160.0)); });
    return cloth;
}

} // namespace devseg::samples
