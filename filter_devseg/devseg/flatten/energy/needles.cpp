#include "devseg/flatten/energy/needles.h"

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

constexpr double widened = 1.02; // area as flattened over that on the surface

bool is_flipped_around(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                       HalfEdge leaving) {
    bool flipped = false;
    mesh::visit_star(surface.twin, leaving, [&](HalfEdge h) {
        const Triangle& t = surface.faces[h / 3];
        flipped = flipped || !(orientation(uv[t[0]], uv[t[1]], uv[t[2]]) > 0.0);
    });
    return flipped;
}

} // namespace

void restore_needles(const Mesh& mesh, const atlas::ChartSurface& surface,
                     const FlatteningProblem& problem, std::vector<Vec2>& uv) {
    for (const Face f : surface.all_faces()) {
        const double area = mesh.face_areas[surface.face[f]];
        if (!(area > 0.0) || problem.area[f] < widened * area)
            continue;
        const Triangle& t = surface.faces[f];
        std::size_t longest = 0; // edge k → k + 1
        const auto length = [&](std::size_t k) { return (uv[t[(k + 1) % 3]] - uv[t[k]]).norm(); };
        for (std::size_t k = 1; k < 3; ++k)
            if (length(k) > length(longest))
                longest = k;
        const Vec2& p = uv[t[longest]];
        const Vec2& q = uv[t[(longest + 1) % 3]];
        const std::size_t apex = (longest + 2) % 3;
        const Vec2 home = uv[t[apex]];
        const Vec2 along = (q - p) / length(longest);
        const Vec2 inwards(-along.y(), along.x());
        const double height = inwards.dot(home - p);
        uv[t[apex]] = home + (2.0 * area / length(longest) - height) * inwards;
        if (is_flipped_around(surface, uv, 3 * f + static_cast<Index>(apex)))
            uv[t[apex]] = home;
    }
}

} // namespace devseg::flatten
