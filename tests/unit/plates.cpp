// The shapes of shapes.h that are made of squares on a lattice.
#include <map>

#include "unit/shapes.h"

namespace devseg::shapes {

namespace {

void add_square(mesh::RawMesh& mesh, Index a, Index b, Index c, Index d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
}

// Points by their position on a lattice, each made once.
class Lattice {
public:
    explicit Lattice(mesh::RawMesh& mesh) : mesh_(mesh) {}
    Index operator()(Index x, Index y, Index z) {
        const auto [place, added] =
            index_.try_emplace({x, y, z}, static_cast<Index>(mesh_.points.size()));
        if (added)
            mesh_.points.emplace_back(x, y, z);
        return place->second;
    }

private:
    mesh::RawMesh& mesh_;
    std::map<std::array<Index, 3>, Index> index_;
};

bool is_cell(const Mask& mask, Index x, Index y) {
    return y >= 0 && y < static_cast<Index>(mask.size()) && x >= 0 &&
           x < static_cast<Index>(mask[y].size()) && mask[y][x] == '#';
}

template <class Visit>
void for_each_cell(const Mask& mask, Visit visit) {
    for (Index y = 0; y < static_cast<Index>(mask.size()); ++y)
        for (Index x = 0; x < static_cast<Index>(mask[y].size()); ++x)
            if (is_cell(mask, x, y))
                visit(x, y);
}

} // namespace

mesh::RawMesh grid(Index columns, Index rows, double width, double height) {
    mesh::RawMesh mesh;
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

mesh::RawMesh plate(const Mask& mask) {
    mesh::RawMesh mesh;
    Lattice point(mesh);
    for_each_cell(mask, [&](Index x, Index y) {
        add_square(mesh, point(x, y, 0), point(x + 1, y, 0), point(x + 1, y + 1, 0),
                   point(x, y + 1, 0));
    });
    return mesh;
}

mesh::RawMesh slab(const Mask& mask) {
    mesh::RawMesh mesh;
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
        mask[1][2 * i + 1] = '.';
    return mask;
}

mesh::RawMesh double_torus() {
    return slab(mask_with_holes(2));
}

mesh::RawMesh cube(Index cells) {
    // Six grids over a lattice of the surface, so that they share the points on their borders.
    mesh::RawMesh mesh;
    Lattice point(mesh);
    for (Index axis = 0; axis < 3; ++axis)
        for (Index side = 0; side < 2; ++side)
            for (Index v = 0; v < cells; ++v)
                for (Index u = 0; u < cells; ++u) {
                    const auto p = [&](Index i, Index j) {
                        std::array<Index, 3> at_lattice{};
                        at_lattice[axis] = side * cells;
                        at_lattice[(axis + 1) % 3] = side == 1 ? i : j;
                        at_lattice[(axis + 2) % 3] = side == 1 ? j : i;
                        return point(at_lattice[0], at_lattice[1], at_lattice[2]);
                    };
                    add_square(mesh, p(u, v), p(u + 1, v), p(u + 1, v + 1), p(u, v + 1));
                }
    for (Vec3& p : mesh.points)
        p /= cells;
    return mesh;
}

mesh::RawMesh plate_with_handle() {
    const Mask mask = {"############", "#.#.#.###.##", "############"};
    mesh::RawMesh mesh = plate(mask);
    constexpr Index steps = 6;
    constexpr double middle = 7.5; // x halfway between the holes that the tube joins
    const auto find = [&](const Vec3& p) {
        Index v = 0;
        while ((mesh.points[v] - p).norm() > 1e-9)
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
            rings[k][i] = find(p);
        }
    for (std::size_t k = 0; k < at(steps); ++k)
        for (std::size_t i = 0; i < 4; ++i)
            add_square(mesh, rings[k][i], rings[k][(i + 1) % 4], rings[k + 1][(i + 1) % 4],
                       rings[k + 1][i]);
    return mesh;
}

} // namespace devseg::shapes
