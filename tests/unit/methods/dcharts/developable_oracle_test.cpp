// Surfaces that are developable as they stand, triangle by triangle: every method must find the
// isometry. The rulings are edges, so that the angles around each inner vertex add up to 2π.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "devseg/flatten/flatten.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

using checks::Disk;
using shapes::pi;

constexpr flatten::FlattenMethod methods[] = {
    flatten::FlattenMethod::symmetric_dirichlet, flatten::FlattenMethod::lscm,
    flatten::FlattenMethod::abf, flatten::FlattenMethod::arap, flatten::FlattenMethod::lpfb};

flatten::FlattenResult flatten(const Disk& disk, flatten::FlattenMethod method) {
    Progress progress;
    return flatten::flatten_charts(disk.mesh, disk.charts, method, progress);
}

// A grid of which ruling i, point j is where `place` puts it.
mesh::RawMesh ruled(Index rulings, Index points, const std::function<Vec3(Index, Index)>& place) {
    mesh::RawMesh mesh = shapes::grid(rulings, points);
    for (Index i = 0; i <= rulings; ++i)
        for (Index j = 0; j <= points; ++j)
            mesh.points[j * (rulings + 1) + i] = place(i, j);
    return mesh;
}

// A part of a cylinder, what is above a slanting plane mirrored at it: folded along an ellipse.
mesh::RawMesh curved_crease() {
    constexpr Index columns = 30;
    constexpr Index rows = 12; // half of them above the crease
    constexpr double slope = 0.4;
    return ruled(columns, rows, [&](Index i, Index j) {
        const double t = 2.6 * i / columns - 0.4;
        const double crease = 1.0 + slope * std::cos(t);
        const double z = 2 * j <= rows ? 2.0 * crease * j / rows
                                       : crease + (2.2 - crease) * (2.0 * j / rows - 1.0);
        Vec3 p(std::cos(t), std::sin(t), z);
        if (2 * j > rows) {
            const Vec3 normal = Vec3(-slope, 0.0, 1.0).normalized();
            p -= 2.0 * normal.dot(p - Vec3(0.0, 0.0, 1.0)) * normal;
        }
        return p;
    });
}

// The rulings are the edges of a polygon on a helix, prolonged: two that follow each other meet in
// a vertex of the polygon, and so the strip between them is flat.
mesh::RawMesh tangent_developable() {
    const auto helix = [](Index i) {
        const double t = 0.12 * i;
        return Vec3(std::cos(t), std::sin(t), 0.5 * t);
    };
    return ruled(30, 8, [&](Index i, Index j) {
        const Vec3 edge = (helix(i + 1) - helix(i)).normalized();
        return Vec3(helix(i + 1) + (0.3 + 0.15 * j) * edge);
    });
}

struct Oracle {
    std::string name;
    Disk disk;
};

std::vector<Oracle> oracles() {
    const auto ruling = [](const Vec3& p) { return std::abs(p.y()) < 1e-12 && p.x() > 0.0; };
    std::vector<Oracle> list;
    list.push_back({"cylinder", Disk(shapes::cylinder_tube(40, 10))});
    list.push_back({"cone", Disk(shapes::cone(40, 12), ruling)});
    list.push_back({"frustum", Disk(shapes::frustum(36, 8, 1.0, 0.3, 1.5))});
    list.push_back({"curved crease", Disk(curved_crease())});
    list.push_back({"tangent developable", Disk(tangent_developable())});
    list.push_back({"folded strip", Disk(shapes::folded_strip(20, 5, 0.2))});
    return list;
}

// Largest difference to 2π of the angles around an inner vertex.
double worst_defect(const Disk& disk) {
    std::vector<double> angle(at(disk.surface.vertex_count()), 0.0);
    for (std::size_t f = 0; f < disk.surface.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Triangle& t = disk.mesh.faces[disk.surface.face[f]];
            const Vec3 a = disk.mesh.points[t[(k + 1) % 3]] - disk.mesh.points[t[k]];
            const Vec3 b = disk.mesh.points[t[(k + 2) % 3]] - disk.mesh.points[t[k]];
            angle[disk.surface.faces[f][k]] += std::atan2(a.cross(b).norm(), a.dot(b));
        }
    for (const Index v : disk.problem.boundary)
        angle[v] = 2.0 * pi;
    double worst = 0.0;
    for (const double sum : angle)
        worst = std::max(worst, std::abs(sum - 2.0 * pi));
    return worst;
}

TEST(DevelopableOracle, TheSurfacesAreDevelopableAndBent) {
    for (const Oracle& oracle : oracles()) {
        SCOPED_TRACE(oracle.name);
        EXPECT_LT(worst_defect(oracle.disk), 1e-12);
        double least = 1.0;
        for (const Vec3& normal : oracle.disk.mesh.face_normals)
            least = std::min(least, normal.dot(oracle.disk.mesh.face_normals.front()));
        EXPECT_LT(least, 0.7);
    }
}

TEST(DevelopableOracle, EveryMethodFindsTheIsometry) {
    for (const Oracle& oracle : oracles())
        for (const flatten::FlattenMethod method : methods) {
            SCOPED_TRACE(oracle.name + ", method " + std::to_string(static_cast<int>(method)));
            const flatten::FlattenResult r = flatten(oracle.disk, method);
            ASSERT_EQ(r.flat.size(), 1U);
            const flatten::FlatChart& chart = r.flat.front();
            EXPECT_EQ(r.cuts, 0);
            EXPECT_FALSE(chart.mended);
            EXPECT_EQ(checks::count_flips(chart.surface.faces, chart.uv), 0);
            EXPECT_NEAR(checks::l2_stretch(oracle.disk.problem, chart.uv), 1.0, 1e-6);
            for (std::size_t f = 0; f < chart.surface.faces.size(); ++f)
                for (const double s : checks::stretches(oracle.disk.problem, chart.uv, f))
                    EXPECT_NEAR(s, 1.0, 1e-4);
        }
}

// With LPFB both sides of every seam are equally long, in charts that are far from developable too.
TEST(DevelopableOracle, LpfbKeepsEveryBoundaryEdgeOfEveryChart) {
    for (const mesh::RawMesh& raw :
         {shapes::hemisphere(20, 8), shapes::torus(14, 9), shapes::sphere(2),
          shapes::with_noise(shapes::grid(12, 12), 0.05, 3)}) {
        const Disk disk(raw);
        const flatten::FlattenResult r = flatten(disk, flatten::FlattenMethod::lpfb);
        for (const flatten::FlatChart& chart : r.flat) {
            EXPECT_FALSE(chart.mended);
            for (const Index h : chart.surface.loops.front()) {
                const double length = disk.mesh.edge_length(chart.surface.mesh_half_edge(h));
                const Vec2 edge =
                    chart.uv[chart.surface.target(h)] - chart.uv[chart.surface.origin(h)];
                EXPECT_NEAR(edge.norm(), length, 1e-6 * length);
            }
        }
    }
}

} // namespace
} // namespace devseg::dcharts
