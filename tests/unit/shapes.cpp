#include "unit/shapes.h"

#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace devseg::shapes {

namespace {

void add_square(RawMesh& mesh, Index a, Index b, Index c, Index d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
}

// Points by their position on a lattice, each made once.
class Lattice {
public:
    explicit Lattice(RawMesh& mesh) : mesh_(mesh) {}
    Index operator()(Index x, Index y, Index z) {
        const auto [place, added] =
            index_.try_emplace({x, y, z}, static_cast<Index>(mesh_.points.size()));
        if (added)
            mesh_.points.emplace_back(x, y, z);
        return place->second;
    }

private:
    RawMesh& mesh_;
    std::map<std::array<Index, 3>, Index> index_;
};

bool is_cell(const Mask& mask, Index x, Index y) {
    return y >= 0 && y < static_cast<Index>(mask.size()) && x >= 0 &&
           x < static_cast<Index>(mask[at(y)].size()) && mask[at(y)][at(x)] == '#';
}

template <class Visit>
void for_each_cell(const Mask& mask, Visit visit) {
    for (Index y = 0; y < static_cast<Index>(mask.size()); ++y)
        for (Index x = 0; x < static_cast<Index>(mask[at(y)].size()); ++x)
            if (is_cell(mask, x, y))
                visit(x, y);
}

std::vector<Vec2> arc(Index steps, double from, double to, const Vec2& centre, double radius) {
    std::vector<Vec2> points;
    for (Index i = 0; i <= steps; ++i) {
        const double t = from + (to - from) * i / steps;
        points.push_back(centre + radius * Vec2(std::cos(t), std::sin(t)));
    }
    return points;
}

} // namespace

RawMesh grid(Index columns, Index rows, double width, double height) {
    RawMesh mesh;
    for (Index y = 0; y <= rows; ++y)
        for (Index x = 0; x <= columns; ++x)
            mesh.points.emplace_back(width * x / columns, height * y / rows, 0.0);
    for (Index y = 0; y < rows; ++y)
        for (Index x = 0; x < columns; ++x) {
            const Index a = y * (columns + 1) + x;
            add_square(mesh, a, a + 1, a + columns + 2, a + columns + 1);
        }
    return mesh;
}

RawMesh plate(const Mask& mask) {
    RawMesh mesh;
    Lattice point(mesh);
    for_each_cell(mask, [&](Index x, Index y) {
        add_square(mesh, point(x, y, 0), point(x + 1, y, 0), point(x + 1, y + 1, 0),
                   point(x, y + 1, 0));
    });
    return mesh;
}

RawMesh slab(const Mask& mask) {
    RawMesh mesh;
    Lattice point(mesh);
    for_each_cell(mask, [&](Index x, Index y) {
        const auto p = [&](Index dx, Index dy, Index z) { return point(x + dx, y + dy, z); };
        add_square(mesh, p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1));
        add_square(mesh, p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0));
        if (!is_cell(mask, x, y - 1))
            add_square(mesh, p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1));
        if (!is_cell(mask, x + 1, y))
            add_square(mesh, p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1));
        if (!is_cell(mask, x, y + 1))
            add_square(mesh, p(1, 1, 0), p(0, 1, 0), p(0, 1, 1), p(1, 1, 1));
        if (!is_cell(mask, x - 1, y))
            add_square(mesh, p(0, 1, 0), p(0, 0, 0), p(0, 0, 1), p(0, 1, 1));
    });
    return mesh;
}

Mask mask_with_holes(Index holes) {
    Mask mask(3, std::string(at(2 * holes + 1), '#'));
    for (Index i = 0; i < holes; ++i)
        mask[1][at(2 * i + 1)] = '.';
    return mask;
}

RawMesh revolve(const std::vector<Vec2>& profile, Index around, bool closed) {
    RawMesh mesh;
    std::vector<std::vector<Index>> rings;
    for (const Vec2& p : profile) {
        std::vector<Index> ring;
        const Index copies = p.x() > 0.0 ? around : 1;
        for (Index i = 0; i < copies; ++i) {
            const double t = 2.0 * pi * i / around;
            ring.push_back(static_cast<Index>(mesh.points.size()));
            mesh.points.emplace_back(p.x() * std::cos(t), p.x() * std::sin(t), p.y());
        }
        rings.push_back(std::move(ring));
    }
    if (closed)
        rings.push_back(rings.front());
    for (std::size_t r = 0; r + 1 < rings.size(); ++r)
        for (std::size_t i = 0; i < at(around); ++i) {
            const auto on = [&](const std::vector<Index>& ring, std::size_t j) {
                return ring[j % ring.size()];
            };
            const Index a = on(rings[r], i);
            const Index b = on(rings[r], i + 1);
            const Index c = on(rings[r + 1], i + 1);
            const Index d = on(rings[r + 1], i);
            if (a == b)
                mesh.faces.push_back({a, c, d});
            else if (c == d)
                mesh.faces.push_back({a, b, c});
            else
                add_square(mesh, a, b, c, d);
        }
    return mesh;
}

RawMesh cylinder_tube(Index around, Index along, double radius, double height) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back(radius, height * i / along);
    return revolve(profile, around);
}

RawMesh capped_cylinder(Index around, Index along, double radius, double height) {
    std::vector<Vec2> profile{{0.0, 0.0}, {0.5 * radius, 0.0}};
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back(radius, height * i / along);
    profile.emplace_back(0.5 * radius, height);
    profile.emplace_back(0.0, height);
    return revolve(profile, around);
}

RawMesh cone(Index around, Index along, double radius, double height) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back(radius * (along - i) / along, height * i / along);
    return revolve(profile, around);
}

RawMesh annulus(Index around, Index rings, double inner, double outer) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= rings; ++i)
        profile.emplace_back(outer + (inner - outer) * i / rings, 0.0);
    return revolve(profile, around);
}

RawMesh hemisphere(Index around, Index rings) {
    std::vector<Vec2> profile = arc(rings, 0.0, 0.5 * pi, Vec2::Zero(), 1.0);
    profile.back().x() = 0.0;
    return revolve(profile, around);
}

RawMesh finger(Index around, Index along, double radius, double length) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back(radius, length * i / along);
    profile.emplace_back(0.0, length + radius);
    return revolve(profile, around);
}

RawMesh torus(Index around, Index tube, double large, double small) {
    std::vector<Vec2> profile = arc(tube, 0.0, 2.0 * pi, Vec2(large, 0.0), small);
    profile.pop_back();
    return revolve(profile, around, true);
}

RawMesh double_torus() {
    return slab(mask_with_holes(2));
}

RawMesh sphere(Index subdivisions) {
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    RawMesh mesh;
    mesh.points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    mesh.faces = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11},
                  {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                  {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8}, {3, 8, 9},
                  {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
    for (Index round = 0; round < subdivisions; ++round) {
        std::map<std::pair<Index, Index>, Index> middles;
        const auto middle = [&](Index a, Index b) {
            const auto [place, added] =
                middles.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.points.size()));
            if (added)
                mesh.points.push_back(mesh.points[at(a)] + mesh.points[at(b)]);
            return place->second;
        };
        std::vector<Triangle> faces;
        for (const Triangle& t : mesh.faces) {
            const Index a = middle(t[0], t[1]);
            const Index b = middle(t[1], t[2]);
            const Index c = middle(t[2], t[0]);
            for (const Triangle& part :
                 {Triangle{t[0], a, c}, Triangle{a, t[1], b}, Triangle{c, b, t[2]}, Triangle{a, b, c}})
                faces.push_back(part);
        }
        mesh.faces = std::move(faces);
        for (Vec3& p : mesh.points)
            p.normalize();
    }
    return mesh;
}

RawMesh cube(Index cells) {
    // Six grids over a lattice of the surface, so that they share the points on their borders.
    RawMesh mesh;
    Lattice point(mesh);
    for (Index axis = 0; axis < 3; ++axis)
        for (Index side = 0; side < 2; ++side)
            for (Index v = 0; v < cells; ++v)
                for (Index u = 0; u < cells; ++u) {
                    const auto p = [&](Index i, Index j) {
                        std::array<Index, 3> at_lattice{};
                        at_lattice[at(axis)] = side * cells;
                        at_lattice[at((axis + 1) % 3)] = side == 1 ? i : j;
                        at_lattice[at((axis + 2) % 3)] = side == 1 ? j : i;
                        return point(at_lattice[0], at_lattice[1], at_lattice[2]);
                    };
                    add_square(mesh, p(u, v), p(u + 1, v), p(u + 1, v + 1), p(u, v + 1));
                }
    for (Vec3& p : mesh.points)
        p /= cells;
    return mesh;
}

RawMesh tetrahedron() {
    return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
            {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
}

RawMesh moebius_strip(Index around, Index across) {
    RawMesh mesh;
    for (Index i = 0; i < around; ++i)
        for (Index j = 0; j <= across; ++j) {
            const double t = 2.0 * pi * i / around;
            const double s = 0.6 * j / across - 0.3;
            const double r = 1.0 + s * std::cos(0.5 * t);
            mesh.points.emplace_back(r * std::cos(t), r * std::sin(t), s * std::sin(0.5 * t));
        }
    const auto point = [&](Index i, Index j) {
        // After one turn the strip's sides are exchanged.
        return i < around ? i * (across + 1) + j : across - j;
    };
    for (Index i = 0; i < around; ++i)
        for (Index j = 0; j < across; ++j)
            add_square(mesh, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
    return mesh;
}

RawMesh plate_with_handle() {
    const Mask mask = {"############", "#.#.#.###.##", "############"};
    RawMesh mesh = plate(mask);
    constexpr Index steps = 6;
    constexpr double middle = 7.5; // x halfway between the holes that the tube joins
    const auto find = [&](const Vec3& p) {
        Index v = 0;
        while ((mesh.points[at(v)] - p).norm() > 1e-9)
            ++v;
        return v;
    };
    const std::array<Vec3, 4> hole = {Vec3(5, 1, 0), Vec3(6, 1, 0), Vec3(6, 2, 0), Vec3(5, 2, 0)};
    std::vector<std::array<Index, 4>> rings(steps + 1);
    for (Index k = 0; k <= steps; ++k)
        for (std::size_t i = 0; i < hole.size(); ++i) {
            const double t = pi * k / steps;
            const double r = middle - hole[i].x();
            const Vec3 p(middle - r * std::cos(t), hole[i].y(), r * std::sin(t));
            if (k > 0 && k < steps)
                mesh.points.push_back(p);
            rings[at(k)][i] = find(p);
        }
    for (std::size_t k = 0; k < at(steps); ++k)
        for (std::size_t i = 0; i < 4; ++i)
            add_square(mesh, rings[k][i], rings[k][(i + 1) % 4], rings[k + 1][(i + 1) % 4],
                       rings[k + 1][i]);
    return mesh;
}

RawMesh helix_strip(Index steps, double turns, double inner, double outer, double rise) {
    RawMesh mesh;
    for (Index i = 0; i <= steps; ++i) {
        const double t = 2.0 * pi * turns * i / steps;
        for (const double r : {outer, inner})
            mesh.points.emplace_back(r * std::cos(t), r * std::sin(t), rise * i / steps);
    }
    for (Index i = 0; i < steps; ++i)
        add_square(mesh, 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
    return mesh;
}

} // namespace devseg::shapes
