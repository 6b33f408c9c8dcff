#include "devseg/atlas/holes.h"

#include <algorithm>
#include <cmath>

namespace devseg::atlas {

namespace {

// A sum of angles from 0 to π each, with one arc tangent for all: directions are multiplied, and
// full turns are counted.
class AngleSum {
public:
    /// By a cosine and a sine, at any scale; a face without size has no angle.
    void add(double cosine, double sine) {
        const bool was_below = is_below();
        const double x = x_ * cosine - y_ * sine;
        const double y = x_ * sine + y_ * cosine;
        const double size = std::max(std::abs(x), std::abs(y));
        if (!(size > 0.0))
            return;
        x_ = x / size;
        y_ = y / size;
        turns_ += was_below && !is_below() ? 1 : 0;
    }
    double radians() const {
        const double angle = std::atan2(y_, x_);
        return (angle < 0.0 ? angle + 2.0 * pi : angle) + 2.0 * pi * turns_;
    }
    Vec2 direction() const { return Vec2(x_, y_) / std::sqrt(x_ * x_ + y_ * y_); }

private:
    bool is_below() const { return y_ < 0.0 || (y_ == 0.0 && x_ < 0.0); } // from π on

    double x_ = 1.0;
    double y_ = 0.0;
    int turns_ = 0;
};

AngleSum angle_at(const Mesh& mesh, const ChartSurface& s, HalfEdge boundary) {
    AngleSum angle;
    const auto point = [&](Vertex v) -> const Vec3& { return mesh.points[s.vertex[v]]; };
    mesh::visit_star(s, boundary, [&](HalfEdge h) {
        const Vec3& at_vertex = point(s.origin(h));
        const Vec3 a = point(s.target(h)) - at_vertex;
        const Vec3 b = point(s.apex(h)) - at_vertex;
        angle.add(a.dot(b), 2.0 * mesh.face_areas[s.face[face_of(h)]]);
    });
    return angle;
}

// The chart lies on the left of its loops: around a hole they turn by −2π.
bool is_flat_hole(const Mesh& mesh, const ChartSurface& s, const std::vector<Index>& loop,
                  const HoleRule& rule) {
    double turned = 0.0;
    double length = 0.0;
    Vec2 direction(1.0, 0.0);
    Vec2 end = Vec2::Zero();
    for (const HalfEdge h : loop) {
        const AngleSum inside = angle_at(mesh, s, h);
        turned += pi - inside.radians();
        // By π less the angle.
        const Vec2 turn = inside.direction();
        direction = Vec2(-direction.x() * turn.x() - direction.y() * turn.y(),
                         direction.x() * turn.y() - direction.y() * turn.x());
        const double edge = mesh.edge_length(s.mesh_half_edge(h));
        end += edge * direction;
        length += edge;
    }
    return std::abs(turned + 2.0 * pi) <= rule.turn && end.norm() <= rule.gap * length;
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

std::optional<std::vector<std::uint8_t>> sound_holes(const Mesh& mesh, const ChartSurface& surface,
                                                     const HoleRule& rule) {
    const auto loops = static_cast<Index>(surface.loops.size());
    if (surface.is_disk())
        return std::vector<std::uint8_t>(1, 0);
    if (loops < 2 || surface.euler_characteristic() != 2 - loops)
        return std::nullopt;
    std::vector<std::uint8_t> flat = flat_holes(mesh, surface, rule);
    const auto rim =
        static_cast<std::size_t>(std::find(flat.begin(), flat.end(), 0) - flat.begin());
    // A rim of two edges encloses nothing in the plane.
    if (std::count(flat.begin(), flat.end(), 0) != 1 || surface.loops[rim].size() <= 2)
        return std::nullopt;
    return flat;
}

bool is_sound(const Mesh& mesh, const ChartSurface& surface, const HoleRule& rule) {
    return sound_holes(mesh, surface, rule).has_value();
}

} // namespace devseg::atlas
