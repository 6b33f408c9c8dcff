#include "devseg/flatten/energy/needles.h"

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

constexpr double widened = 1.02; // area as flattened over that on the surface

bool is_flipped_around(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                       Index leaving) {
    bool flipped = false;
    mesh::visit_star(surface.twin, leaving, [&](Index h) {
        const Triangle& t = surface.corners[at(h / 3)];
        flipped = flipped || !(orientation(uv[at(t[0])], uv[at(t[1])], uv[at(t[2])]) > 0.0);
    });
    return flipped;
}

} // namespace

void restore_needles(const Mesh& mesh, const atlas::ChartSurface& surface,
                     const FlatteningProblem& problem, std::vector<Vec2>& uv) {
    for (Index f = 0; f < surface.face_count(); ++f) {
        const double area = mesh.face_areas[at(surface.face[at(f)])];
        if (!(area > 0.0) || problem.area[at(f)] < widened * area)
            continue;
        const Triangle& t = surface.corners[at(f)];
        std::size_t longest = 0; // edge k → k + 1
        const auto length = [&](std::size_t k) {
            return (uv[at(t[(k + 1) % 3])] - uv[at(t[k])]).norm();
        };
        for (std::size_t k = 1; k < 3; ++k)
            if (length(k) > length(longest))
                longest = k;
        const Vec2& p = uv[at(t[longest])];
        const Vec2& q = uv[at(t[(longest + 1) % 3])];
        const std::size_t apex = (longest + 2) % 3;
        const Vec2 home = uv[at(t[apex])];
        const Vec2 along = (q - p) / length(longest);
        const Vec2 inwards(-along.y(), along.x());
        const double height = inwards.dot(home - p);
        uv[at(t[apex])] = home + (2.0 * area / length(longest) - height) * inwards;
        if (is_flipped_around(surface, uv, 3 * f + static_cast<Index>(apex)))
            uv[at(t[apex])] = home;
    }
}

} // namespace devseg::flatten
