// Gauss areas against closed forms: the sphere of normals, Girard's theorem and angle defects.
#include "devseg/metrics/gauss_area.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::metrics {
namespace {

using shapes::pi;

constexpr double crease_angle = pi / 4.0;

GaussAreas areas_of(const Mesh& mesh) {
    return compute_gauss_areas(mesh, crease_angle);
}

double sum(const std::vector<double>& values) {
    double result = 0.0;
    for (const double v : values)
        result += v;
    return result;
}

TEST(GaussArea, ClosedConvexShapesSweepTheSphereOnce) {
    const std::vector<mesh::RawMesh> convex = {
        shapes::sphere(0),
        shapes::sphere(4),
        shapes::cube(1),
        shapes::cube(5),
        shapes::tetrahedron(),
        shapes::capped_cylinder(24, 5),
        shapes::revolve({{0, -1}, {1.0, -0.5}, {1.2, 0.3}, {0, 1}}, 16)};
    for (std::size_t i = 0; i < convex.size(); ++i) {
        SCOPED_TRACE("shape " + std::to_string(i));
        const Mesh mesh = checks::gated(convex[i]);
        const GaussAreas areas = areas_of(mesh);
        EXPECT_NEAR(areas.total, 4.0 * pi, 1e-9);
        EXPECT_NEAR(sum(areas.face) + 0.5 * sum(areas.edge) + sum(areas.vertex), areas.total,
                    1e-12);
    }
}

TEST(GaussArea, CornersOfACubeAreOctants) {
    const Mesh mesh = checks::gated(shapes::cube(3));
    const GaussAreas areas = areas_of(mesh);
    EXPECT_EQ(sum(areas.face), 0.0);
    EXPECT_EQ(sum(areas.edge), 0.0); // straight creases sweep an arc
    int corners = 0;
    for (const double a : areas.vertex) {
        corners += a > 0.0 ? 1 : 0;
        EXPECT_TRUE(a == 0.0 || std::abs(a - pi / 2.0) < 1e-12) << a;
    }
    EXPECT_EQ(corners, 8);
}

TEST(GaussArea, SmoothEdgesAndVerticesHaveNone) {
    const GaussAreas areas = areas_of(checks::gated(shapes::sphere(3)));
    EXPECT_EQ(sum(areas.edge), 0.0);
    EXPECT_EQ(sum(areas.vertex), 0.0);
}

TEST(GaussArea, NormalsOfASphereAreExact) {
    // The weights of Max give the normal of the sphere through a vertex and its neighbours.
    const Mesh mesh = checks::gated(shapes::sphere(2));
    const std::vector<Vec3> normals =
        split_normals(mesh, std::vector<std::uint8_t>(mesh.twin.size(), 0));
    for (const HalfEdge h : mesh.all_half_edges())
        EXPECT_NEAR(normals[h].dot(mesh.points[mesh.origin(h)].normalized()), 1.0, 1e-12);
}

TEST(GaussArea, ACreaseThatEndsDoesNotSplitTheNormal) {
    // A fold along half of a line only: its inner end has one normal.
    mesh::RawMesh raw = shapes::grid(8, 8);
    for (Vec3& p : raw.points)
        if (p.x() > 0.5 && p.y() > 0.55)
            p.z() = 2.0 * (p.x() - 0.5) * (p.y() - 0.5);
    const Mesh mesh = checks::gated(raw);
    std::vector<std::uint8_t> crease(mesh.twin.size(), 0);
    Index end = -1; // an inner vertex with a single crease
    for (Index h = 0; h < mesh.half_edge_count() && end < 0; ++h)
        if (mesh.twin[h] >= 0 && mesh::visit_star(mesh, h, [](Index) {}) &&
            mesh::visit_star(mesh, mesh.twin[h], [](Index) {})) {
            crease[h] = crease[mesh.twin[h]] = 1;
            end = mesh.origin(h);
        }
    ASSERT_GE(end, 0);
    const std::vector<Vec3> normals = split_normals(mesh, crease);
    Vec3 first = Vec3::Zero();
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.origin(h) == end) {
            if (first.isZero())
                first = normals[h];
            EXPECT_EQ(normals[h], first);
        }
}

TEST(GaussArea, SphericalPolygonsFollowGirard) {
    const std::vector<Vec3> octant = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    EXPECT_NEAR(signed_spherical_area(octant), pi / 2.0, 1e-15);
    EXPECT_NEAR(signed_spherical_area({octant[0], octant[2], octant[1]}), -pi / 2.0, 1e-15);
    EXPECT_EQ(signed_spherical_area({octant[0], octant[1]}), 0.0);
    const std::vector<Vec3> two = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(),
                                   Vec3(1, -1, 0).normalized()};
    // An octant and the half octant beside it.
    EXPECT_NEAR(std::abs(signed_spherical_area(two)), 3.0 * pi / 4.0, 1e-12);
}

TEST(GaussArea, ChartsNeverExceedTheMesh) {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        const Mesh mesh = checks::gated(shapes::with_noise(shapes::double_torus(), 0.2, seed));
        const GaussAreas areas = areas_of(mesh);
        shapes::Random random(seed);
        std::vector<Index> labels;
        for (std::size_t f = 0; f < mesh.faces.size(); ++f)
            labels.push_back(random.below(3));
        const double charts = sum(chart_gauss_areas(mesh, areas, labels, 3));
        EXPECT_LT(charts, areas.total); // creases on borders count nowhere
        EXPECT_GE(charts, sum(areas.face) - 1e-12);
        const std::vector<Index> one(mesh.faces.size(), 0);
        EXPECT_NEAR(chart_gauss_areas(mesh, areas, one, 1)[0], areas.total, 1e-9);
    }
}

TEST(GaussArea, BoundariesHaveNone) {
    const Mesh mesh = checks::gated(shapes::hemisphere(16, 6));
    const GaussAreas areas = areas_of(mesh);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] < 0) {
            EXPECT_EQ(areas.edge[h], 0.0);
            EXPECT_EQ(areas.vertex[mesh.origin(h)], 0.0);
        }
}

TEST(GaussArea, SizeDoesNotMatter) {
    const mesh::RawMesh raw = shapes::with_noise(shapes::cube(4), 0.02, 3);
    const double expected = areas_of(checks::gated(raw)).total;
    for (const double scale : {1e-9, 1e9})
        EXPECT_NEAR(areas_of(checks::gated(shapes::moved(raw, scale, Vec3::Zero()))).total,
                    expected, 1e-9);
}

TEST(GaussArea, ShortCreasesAreNoFeatures) {
    const Mesh mesh = checks::gated(shapes::cube(6));
    const std::vector<std::uint8_t> crease = find_creases(mesh, crease_angle);
    EXPECT_EQ(long_creases(mesh, crease, 6), crease);
    std::vector<std::uint8_t> single(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (crease[h] != 0) {
            single[h] = single[mesh.twin[h]] = 1;
            break;
        }
    EXPECT_EQ(long_creases(mesh, single, 6), std::vector<std::uint8_t>(mesh.twin.size(), 0));
}

TEST(GaussArea, DeviationOfEquationThree) {
    EXPECT_EQ(standard_deviation({2.0, 2.0, 2.0}), 0.0);
    EXPECT_NEAR(standard_deviation({1.0, 3.0}), 1.0, 1e-15);
}

} // namespace
} // namespace devseg::metrics
