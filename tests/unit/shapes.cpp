#include "unit/shapes.h"

#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace devseg::shapes {

namespace {

void add_square(mesh::RawMesh& mesh, Index a, Index b, Index c, Index d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
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

mesh::RawMesh revolve(const std::vector<Vec2>& profile, Index around, bool closed) {
    mesh::RawMesh mesh;
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

mesh::RawMesh cylinder_tube(Index around, Index along, double radius, double height) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back(radius, height * i / along);
    return revolve(profile, around);
}

mesh::RawMesh capped_cylinder(Index around, Index along, double radius, double height) {
    std::vector<Vec2> profile{{0.0, 0.0}, {0.5 * radius, 0.0}};
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back(radius, height * i / along);
    profile.emplace_back(0.5 * radius, height);
    profile.emplace_back(0.0, height);
    return revolve(profile, around);
}

mesh::RawMesh cone(Index around, Index along, double radius, double height) {
    return frustum(around, along, radius, 0.0, height);
}

mesh::RawMesh frustum(Index around, Index along, double radius, double top, double height) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back((radius * (along - i) + top * i) / along, height * i / along);
    return revolve(profile, around);
}

mesh::RawMesh annulus(Index around, Index rings, double inner, double outer) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= rings; ++i)
        profile.emplace_back(outer + (inner - outer) * i / rings, 0.0);
    return revolve(profile, around);
}

mesh::RawMesh hemisphere(Index around, Index rings) {
    std::vector<Vec2> profile = arc(rings, 0.0, 0.5 * pi, Vec2::Zero(), 1.0);
    profile.back().x() = 0.0;
    return revolve(profile, around);
}

mesh::RawMesh finger(Index around, Index along, double radius, double length) {
    std::vector<Vec2> profile;
    for (Index i = 0; i <= along; ++i)
        profile.emplace_back(radius, length * i / along);
    profile.emplace_back(0.0, length + radius);
    return revolve(profile, around);
}

mesh::RawMesh torus(Index around, Index tube, double large, double small) {
    std::vector<Vec2> profile = arc(tube, 0.0, 2.0 * pi, Vec2(large, 0.0), small);
    profile.pop_back();
    return revolve(profile, around, true);
}

mesh::RawMesh sphere(Index subdivisions) {
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    mesh::RawMesh mesh;
    mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                  {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                  {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                  {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (Index round = 0; round < subdivisions; ++round) {
        std::map<std::pair<Index, Index>, Index> middles;
        const auto middle = [&](Index a, Index b) {
            const auto [place, added] =
                middles.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.points.size()));
            if (added)
                mesh.points.push_back(mesh.points[a] + mesh.points[b]);
            return place->second;
        };
        std::vector<Triangle> faces;
        for (const Triangle& t : mesh.faces) {
            const Index a = middle(t[0], t[1]);
            const Index b = middle(t[1], t[2]);
            const Index c = middle(t[2], t[0]);
            for (const Triangle& part : {Triangle{t[0], a, c}, Triangle{a, t[1], b},
                                         Triangle{c, b, t[2]}, Triangle{a, b, c}})
                faces.push_back(part);
        }
        mesh.faces = std::move(faces);
        for (Vec3& p : mesh.points)
            p.normalize();
    }
    return mesh;
}

mesh::RawMesh tetrahedron() {
    return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
            {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
}

mesh::RawMesh moebius_strip(Index around, Index across) {
    mesh::RawMesh mesh;
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

mesh::RawMesh ramp(double turns, double waves) {
    mesh::RawMesh raw = grid(200, 50);
    for (Vec3& p : raw.points) {
        const double angle = 2.0 * pi * turns * p.x();
        const double radius = 0.5 + 0.5 * p.y();
        p = Vec3(radius * std::cos(angle), radius * std::sin(angle),
                 0.02 * angle + waves * std::sin(40.0 * p.x()) * std::sin(17.0 * p.y()));
    }
    return raw;
}

mesh::RawMesh helix_strip(Index steps, double turns, double inner, double outer, double rise) {
    mesh::RawMesh mesh;
    for (Index i = 0; i <= steps; ++i) {
        const double t = 2.0 * pi * turns * i / steps;
        for (const double r : {outer, inner})
            mesh.points.emplace_back(r * std::cos(t), r * std::sin(t), rise * i / steps);
    }
    for (Index i = 0; i < steps; ++i)
        add_square(mesh, 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
    return mesh;
}

mesh::RawMesh zigzag_fan(Index sectors, double angle, double inner, double outer, Index rows) {
    const double turn = 0.9 * 2.0 * pi / sectors; // between rays, seen from above
    // cos(angle) = cos²ψ cos(turn) − sin²ψ
    const double c = (std::cos(angle) + 1.0) / (std::cos(turn) + 1.0);
    const double psi = std::acos(std::sqrt(c));
    mesh::RawMesh raw = grid(sectors, rows);
    for (Vec3& p : raw.points) {
        const int i = static_cast<int>(std::lround(p.x() * sectors));
        const double r = inner + (outer - inner) * p.y();
        const double up = i % 2 == 0 ? psi : -psi;
        p = r * Vec3(std::cos(turn * i) * std::cos(up), -std::sin(turn * i) * std::cos(up),
                     std::sin(up));
    }
    return raw;
}

mesh::RawMesh folded_strip(Index folds, Index rows, double angle) {
    mesh::RawMesh mesh = grid(folds, rows);
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    for (Index i = 0; i <= folds; ++i) {
        const Vec3 bottom(0.3 * i, 0.0, 0.0);
        const Vec3 ruling(0.6 * std::sin(0.3 * i), 2.0, 0.0);
        place = place * Eigen::Translation3d(bottom) *
                Eigen::AngleAxisd(angle, ruling.normalized()) * Eigen::Translation3d(-bottom);
        for (Index j = 0; j <= rows; ++j)
            mesh.points[j * (folds + 1) + i] = place * (bottom + ruling * j / rows);
    }
    return mesh;
}

} // namespace devseg::shapes
