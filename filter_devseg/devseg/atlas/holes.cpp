#include "devseg/atlas/holes.h"

#include <algorithm>
#include <cmath>

#include "devseg/mesh/angle_defects.h"

namespace devseg::atlas {

namespace {

double angle_at(const Mesh& mesh, const ChartSurface& s, HalfEdge boundary) {
    double angle = 0.0;
    const auto point = [&](Vertex v) -> const Vec3& { return mesh.points[s.vertex[v]]; };
    mesh::visit_star(s, boundary, [&](HalfEdge h) {
        angle += mesh::corner_angle(point(s.origin(h)), point(s.target(h)), point(s.apex(h)));
    });
    return angle;
}

// The chart lies on the left of its loops: around a hole they turn by −2π.
bool is_flat_hole(const Mesh& mesh, const ChartSurface& s, const std::vector<Index>& loop,
                  const HoleRule& rule) {
    double direction = 0.0;
    double length = 0.0;
    Vec2 end = Vec2::Zero();
    for (const HalfEdge h : loop) {
        direction += pi - angle_at(mesh, s, h);
        const double edge = mesh.edge_length(s.mesh_half_edge(h));
        end += edge * Vec2(std::cos(direction), std::sin(direction));
        length += edge;
    }
    return std::abs(direction + 2.0 * pi) <= rule.turn && end.norm() <= rule.gap * length;
}

} // namespace

std::vector<std::uint8_t> flat_holes(const Mesh& mesh, const ChartSurface& surface,
                                     const HoleRule& rule) {
    std::vector<std::uint8_t> flat(surface.loops.size(), 0);
    if (flat.size() < 2)
        return flat;
    for (std::size_t l = 0; l < flat.size(); ++l)
        flat[l] = is_flat_hole(mesh, surface, surface.loops[l], rule) ? 1 : 0;
    if (std::find(flat.begin(), flat.end(), 0) == flat.end())
        flat.assign(flat.size(), 0);
    return flat;
}

bool is_sound(const Mesh& mesh, const ChartSurface& surface, const HoleRule& rule) {
    if (surface.is_disk())
        return true;
    const auto loops = static_cast<Index>(surface.loops.size());
    if (loops < 2 || surface.euler_characteristic() != 2 - loops)
        return false;
    const std::vector<std::uint8_t> flat = flat_holes(mesh, surface, rule);
    const auto rim =
        static_cast<std::size_t>(std::find(flat.begin(), flat.end(), 0) - flat.begin());
    // A rim of two edges encloses nothing in the plane.
    return std::count(flat.begin(), flat.end(), 0) == 1 && surface.loops[rim].size() > 2;
}

} // namespace devseg::atlas
