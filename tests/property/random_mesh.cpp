#include "property/random_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "unit/shapes.h"

namespace devseg::shapes {

namespace {

bool chance(Random& random, double probability) {
    return random.uniform(0.0, 1.0) < probability;
}

Index between(Random& random, Index low, Index high) {
    return low + random.below(high - low + 1);
}

// Random cells: holes are boundaries of plates and handles of slabs, diagonal cells touch in bow-
// ties and crowded edges.
Mask random_mask(Random& random, double filled) {
    Mask mask(at(between(random, 2, 6)), std::string(at(between(random, 2, 6)), '.'));
    for (std::string& row : mask)
        for (char& cell : row)
            cell = chance(random, filled) ? '#' : '.';
    mask[0][0] = '#';
    return mask;
}

Mask framed_mask(Random& random) {
    const Index holes = between(random, 1, 4);
    Mask mask = mask_with_holes(holes);
    for (std::string& row : mask)
        if (chance(random, 0.3))
            row += '#';
    for (std::string& row : mask)
        row.resize(mask[0].size(), '.');
    return mask;
}

mesh::RawMesh turned_profile(Random& random) {
    std::vector<Vec2> profile;
    const Index rings = between(random, 2, 9);
    for (Index i = 0; i <= rings; ++i)
        profile.emplace_back(random.uniform(0.2, 1.5), 0.5 * static_cast<double>(i));
    if (chance(random, 0.5))
        profile.front().x() = 0.0;
    if (chance(random, 0.5))
        profile.back().x() = 0.0;
    return revolve(profile, between(random, 3, 20));
}

mesh::RawMesh base_mesh(Random& random, std::string& recipe) {
    const Index around = between(random, 3, 24);
    const Index along = between(random, 1, 10);
    switch (random.below(16)) {
    case 0:
        recipe = "sphere";
        return sphere(random.below(3));
    case 1:
        recipe = "slab";
        return slab(framed_mask(random));
    case 2:
        recipe = "plate";
        return plate(framed_mask(random));
    case 3:
        recipe = "torus";
        return torus(around, 3 + along);
    case 4:
        recipe = "profile";
        return turned_profile(random);
    case 5:
        recipe = "folded strip";
        return folded_strip(between(random, 2, 16), between(random, 1, 5),
                            random.uniform(-2.8, 2.8));
    case 6:
        recipe = "helix";
        return helix_strip(between(random, 6, 60), random.uniform(0.3, 3.0), 0.5, 1.0,
                           random.uniform(0.1, 2.0));
    case 7:
        recipe = "cube";
        return cube(between(random, 1, 6));
    case 8:
        recipe = "cylinder";
        return capped_cylinder(around, along);
    case 9:
        recipe = "cone";
        return cone(around, along, 1.0, random.uniform(0.1, 4.0));
    case 10:
        recipe = "tube";
        return cylinder_tube(around, along, 1.0, random.uniform(0.1, 8.0));
    case 11:
        recipe = "tetrahedron";
        return tetrahedron();
    case 12:
        recipe = "finger";
        return finger(around, along, 1.0, random.uniform(0.5, 12.0));
    case 13:
        recipe = "handle";
        return plate_with_handle();
    case 14:
        recipe = "annulus";
        return annulus(around, along, 0.5, 2.0);
    default:
        recipe = "grid";
        return grid(between(random, 1, 12), between(random, 1, 12));
    }
}

Vec3 face_point(const mesh::RawMesh& mesh, const Triangle& t, Random& random) {
    const double a = random.uniform(0.2, 0.5);
    const double b = random.uniform(0.2, 0.4);
    return a * mesh.points[t[0]] + b * mesh.points[t[1]] + (1.0 - a - b) * mesh.points[t[2]];
}

// Faces get a vertex inside: valences and sizes vary.
void split_faces(mesh::RawMesh& mesh, Random& random, double share) {
    for (std::size_t f = 0, n = mesh.faces.size(); f < n; ++f) {
        if (!chance(random, share))
            continue;
        const Triangle t = mesh.faces[f];
        const auto middle = static_cast<Index>(mesh.points.size());
        mesh.points.push_back(face_point(mesh, t, random));
        mesh.faces[f] = {t[0], t[1], middle};
        mesh.faces.push_back({t[1], t[2], middle});
        mesh.faces.push_back({t[2], t[0], middle});
    }
}

// All faces in four.
void subdivide(mesh::RawMesh& mesh) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
        const auto [place, fresh] = middles.try_emplace(std::minmax(a, b), 0);
        if (fresh) {
            place->second = static_cast<Index>(mesh.points.size());
            const Vec3 p = 0.5 * (mesh.points[a] + mesh.points[b]);
            mesh.points.push_back(p);
        }
        return place->second;
    };
    std::vector<Triangle> faces;
    for (const Triangle& t : mesh.faces) {
        const Index ab = middle(t[0], t[1]);
        const Index bc = middle(t[1], t[2]);
        const Index ca = middle(t[2], t[0]);
        faces.insert(faces.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
    }
    mesh.faces = std::move(faces);
}

// Faces around random vertices are taken away: holes, also such that touch.
void remove_stars(mesh::RawMesh& mesh, Random& random, Index count) {
    for (Index i = 0; i < count && mesh.faces.size() > 8; ++i) {
        const Index v = random.below(static_cast<Index>(mesh.points.size()));
        mesh::RawMesh rest = mesh;
        rest.faces.clear();
        for (const Triangle& t : mesh.faces)
            if (t[0] != v && t[1] != v && t[2] != v)
                rest.faces.push_back(t);
        if (rest.faces.size() >= 2)
            mesh = std::move(rest);
    }
}

double mean_edge(const mesh::RawMesh& mesh) {
    double sum = 0.0;
    for (const Triangle& t : mesh.faces)
        sum += (mesh.points[t[1]] - mesh.points[t[0]]).norm();
    return sum / static_cast<double>(mesh.faces.size());
}

void bend(mesh::RawMesh& mesh, Random& random) {
    const double strength = random.uniform(0.1, 1.5);
    const double wave = random.uniform(0.3, 2.0);
    for (Vec3& p : mesh.points)
        p += strength *
             Vec3(std::sin(wave * p.y()), 0.3 * std::sin(wave * p.z()), std::cos(wave * p.x()));
}

// One defect, at a random place.
std::string add_defect(mesh::RawMesh& mesh, Random& random) {
    const auto face = [&] { return random.below(static_cast<Index>(mesh.faces.size())); };
    const auto vertex = [&] { return mesh.faces[face()][random.below(3)]; };
    const Triangle t = mesh.faces[face()];
    switch (random.below(10)) {
    case 0:
        mesh.faces.push_back(t);
        return "double face";
    case 1:
        mesh.faces.push_back({t[0], t[2], t[1]});
        return "double face turned over";
    case 2:
        mesh.faces.push_back({t[0], t[1], t[1]});
        return "repeated vertex";
    case 3: { // a fin on an edge
        mesh.points.push_back(mesh.points[t[0]] + random.direction());
        mesh.faces.push_back({t[0], t[1], static_cast<Index>(mesh.points.size()) - 1});
        return "fin";
    }
    case 4: { // two vertices become one
        const Index a = vertex();
        const Index b = vertex();
        for (Triangle& other : mesh.faces)
            std::replace(other.begin(), other.end(), a, b);
        return "joined vertices";
    }
    case 5:
        mesh.points[t[0]] = mesh.points[t[1]];
        return "two vertices at one place";
    case 6:
        mesh.points[t[0]] = 0.5 * (mesh.points[t[1]] + mesh.points[t[2]]);
        return "vertex on an edge";
    case 7: {
        const Vec3 way = mesh.points[t[1]] - mesh.points[t[0]];
        mesh.points[t[0]] += (1.0 - std::pow(10.0, random.uniform(-12.0, -3.0))) * way;
        return "needle";
    }
    case 8:
        mesh = with_random_orientations(mesh, static_cast<std::uint32_t>(random.below(1000)));
        return "random orientations";
    default:
        mesh.points.push_back(100.0 * random.direction());
        return "isolated vertex";
    }
}

void add_defects(RandomMesh& mesh, Random& random) {
    if (chance(random, 0.15)) {
        mesh.raw =
            chance(random, 0.5) ? plate(random_mask(random, 0.6)) : slab(random_mask(random, 0.7));
        mesh.recipe = "random cells";
    } else if (chance(random, 0.05)) {
        mesh.raw = moebius_strip(between(random, 5, 20), between(random, 1, 3));
        mesh.recipe = "moebius";
    }
    for (Index i = between(random, 0, 3); i > 0; --i)
        mesh.recipe += ", " + add_defect(mesh.raw, random);
    if (chance(random, 0.05)) {
        for (Vec3& p : mesh.raw.points)
            p.z() *= 1e-4;
        mesh.recipe += ", pressed flat";
    }
}

} // namespace

RandomMesh random_mesh(Random& random, Defects defects) {
    RandomMesh mesh;
    mesh.raw = base_mesh(random, mesh.recipe);
    const auto change = [&](double probability, const char* name, auto edit) {
        if (!chance(random, probability))
            return;
        edit();
        mesh.recipe += std::string(", ") + name;
    };
    const auto small = [&](std::size_t most) { return mesh.raw.faces.size() <= most; };
    change(small(60) ? 0.5 : 0.0, "subdivided", [&] { subdivide(mesh.raw); });
    change(0.25, "bent", [&] { bend(mesh.raw, random); });
    change(small(250) ? 0.3 : 0.0, "split", [&] { split_faces(mesh.raw, random, 0.3); });
    change(0.3, "holes", [&] { remove_stars(mesh.raw, random, between(random, 1, 4)); });
    change(0.6, "noise", [&] {
        const auto seed = static_cast<std::uint32_t>(random.below(1 << 30));
        mesh.raw = with_noise(mesh.raw, random.uniform(0.0, 0.25) * mean_edge(mesh.raw), seed);
    });
    change(small(200) ? 0.15 : 0.0, "another one", [&] {
        std::string other;
        mesh.raw = join(mesh.raw, moved(base_mesh(random, other), 0.5, {5.0, 1.0, -2.0}));
        mesh.recipe += ", " + other;
    });
    if (defects == Defects::any)
        add_defects(mesh, random);
    return mesh;
}

mesh::RawMesh moved_rigidly(const mesh::RawMesh& mesh, double scale, Random& random) {
    const Eigen::AngleAxisd turn(random.uniform(0.0, 2.0 * pi), random.direction());
    mesh::RawMesh result = mesh;
    const Vec3 offset = 3.0 * scale * random.direction();
    for (Vec3& p : result.points)
        p = scale * (turn * p) + offset;
    return result;
}

} // namespace devseg::shapes
