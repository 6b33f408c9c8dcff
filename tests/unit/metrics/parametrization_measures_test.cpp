#include "devseg/metrics/parametrization.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::metrics {
namespace {

using Map = std::function<Vec2(const Vec2&)>;

constexpr Index cells = 7;

// A square cut into 7 × 7 × 2 faces, [0, 1]² in the model's units.
struct Square {
    explicit Square(double size = 1.0)
        : raw(shapes::grid(cells, cells, size, size)), mesh(checks::gated(raw)) {
        for (const Triangle& t : raw.faces)
            for (const Index v : t)
                plane.push_back(raw.points[v].head<2>());
    }
    CornerUv map(const Map& f) const {
        CornerUv uv;
        for (const Vec2& p : plane)
            uv.push_back(f(p));
        return uv;
    }
    mesh::RawMesh raw;
    Mesh mesh;
    CornerUv plane; // the square itself at the corners
};

ParametrizationMeasures measure(const Square& square, const Map& f) {
    return measure_parametrization(square.mesh, square.map(f));
}

double angle(const Vec2& a, const Vec2& b) {
    return std::atan2(std::abs(a.x() * b.y() - a.y() * b.x()), a.dot(b));
}

// Root mean square change of the angles of both kinds of triangles under a linear map.
double linear_shear(const Eigen::Matrix2d& m) {
    const Vec2 kinds[2][3] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
    double sum = 0.0;
    for (const auto& t : kinds)
        for (int i = 0; i < 3; ++i) {
            const Vec2 a = t[(i + 1) % 3] - t[i];
            const Vec2 b = t[(i + 2) % 3] - t[i];
            sum += std::pow(angle(m * a, m * b) - angle(a, b), 2) / 6.0;
        }
    return std::sqrt(sum);
}

void expect_isometric(const ParametrizationMeasures& m) {
    EXPECT_NEAR(m.l2_stretch, 1.0, 1e-12);
    EXPECT_NEAR(m.linf_stretch, 1.0, 1e-9);
    EXPECT_NEAR(m.l2_shear, 0.0, 1e-7);
    EXPECT_NEAR(m.symmetric_dirichlet_energy, 1.0, 1e-12);
    EXPECT_NEAR(m.max_area_change, 0.0, 1e-9);
}

TEST(ParametrizationMeasures, IsometriesAtAnyScaleAndPlace) {
    for (const double size : {1e-6, 1.0, 40.0})
        for (const double scale : {1e-4, 1.0, 1e3}) {
            const Square square(size);
            const ParametrizationMeasures m = measure(square, [&](const Vec2& p) {
                return Vec2(scale * (Eigen::Rotation2Dd(0.7) * p) + Vec2(5.0, -3.0) * scale * size);
            });
            expect_isometric(m);
            EXPECT_EQ(m.charts_number, 1);
            EXPECT_EQ(m.disk_charts_number, 1);
            EXPECT_EQ(m.flipped_faces_number, 0);
            EXPECT_EQ(m.overlapping_faces_number, 0);
            EXPECT_EQ(m.seam_length, 0.0);
        }
}

// The last row of squares is a billionth as high, and a chart of its own that the plane shows
// wider: it has no area whose stretch anybody could see.
TEST(ParametrizationMeasures, ChartsThatAreLinesHaveNoStretch) {
    mesh::RawMesh raw = shapes::grid(cells, cells, 1.0, 1.0);
    CornerUv uv;
    const double last = 1.0 - 1.0 / cells;
    const auto is_last = [&](const Triangle& t) {
        return raw.points[t[0]].y() + raw.points[t[1]].y() + raw.points[t[2]].y() > 3.0 * last;
    };
    for (const Triangle& t : raw.faces)
        for (const Index v : t)
            uv.push_back(raw.points[v].head<2>() + (is_last(t) ? Vec2(0.0, 1.0) : Vec2::Zero()));
    for (Vec3& p : raw.points)
        if (p.y() > 1.0 - 0.5 / cells)
            p.y() = 1.0 - 1.0 / cells + 1e-9;
    const ParametrizationMeasures m = measure_parametrization(checks::gated(raw), uv);
    ASSERT_EQ(m.charts_number, 2);
    EXPECT_NEAR(m.linf_stretch, 1.0, 1e-9);
    EXPECT_NEAR(std::max(m.charts[0].l2_stretch, m.charts[1].l2_stretch), 1.0, 1e-9);
    EXPECT_EQ(m.flipped_faces_number, 0);
}

TEST(ParametrizationMeasures, ShearedSquare) {
    const Square square;
    const double k = 0.8;
    Eigen::Matrix2d shear;
    shear << 1.0, k, 0.0, 1.0;
    const ParametrizationMeasures m = measure(square, [&](const Vec2& p) { return shear * p; });
    EXPECT_NEAR(m.l2_stretch, std::sqrt(1.0 + 0.5 * k * k), 1e-12);
    EXPECT_NEAR(m.linf_stretch, 0.5 * (k + std::sqrt(k * k + 4.0)), 1e-12);
    EXPECT_NEAR(m.symmetric_dirichlet_energy, 1.0 + 0.5 * k * k, 1e-12);
    EXPECT_NEAR(m.l2_shear, linear_shear(shear), 1e-12);
    EXPECT_NEAR(m.max_area_change, 0.0, 1e-12);
    // [0, 1]² becomes a parallelogram in a box of 1.8 × 1.
    EXPECT_NEAR(m.packing_efficiency, 1.0 / 1.8, 1e-12);
}

TEST(ParametrizationMeasures, AnisotropicScaling) {
    const Square square;
    for (const auto& [a, b] : {std::pair(2.0, 0.5), {3.0, 1.0}, {0.2, 7.0}}) {
        const Eigen::Matrix2d scale = Eigen::Vector2d(a, b).asDiagonal();
        const ParametrizationMeasures m = measure(square, [&](const Vec2& p) { return scale * p; });
        EXPECT_NEAR(m.l2_stretch,
                    std::sqrt(0.5 * (1.0 / (a * a) + 1.0 / (b * b))) * std::sqrt(a * b), 1e-9);
        const double ratio = std::max(a, b) / std::min(a, b);
        EXPECT_NEAR(m.linf_stretch, std::sqrt(ratio), 1e-9);
        EXPECT_NEAR(m.symmetric_dirichlet_energy, 0.5 * (ratio + 1.0 / ratio), 1e-9);
        EXPECT_NEAR(m.l2_shear, linear_shear(scale), 1e-9);
        EXPECT_NEAR(m.packing_efficiency, 1.0, 1e-12);
    }
}

TEST(ParametrizationMeasures, AreaChange) {
    // The left part is laid out twice as wide: with 3/7 of the square, areas are 2 and 1 over 10/7.
    const Square square;
    const double edge = 3.0 / cells;
    const ParametrizationMeasures m = measure(square, [&](const Vec2& p) {
        return Vec2(p.x() < edge ? 2.0 * p.x() : p.x() + edge, p.y());
    });
    const double scale = 1.0 / (1.0 + edge);
    EXPECT_NEAR(m.max_area_change, std::abs(1.0 - 2.0 * scale), 1e-12);
    // Per face: stretched by 2 along x, or not, and all multiplied by √scale.
    const double left = 0.5 * (0.25 + 1.0) / scale;
    const double right = 1.0 / scale;
    EXPECT_NEAR(m.l2_stretch, std::sqrt(edge * left + (1.0 - edge) * right), 1e-12);
    EXPECT_NEAR(m.linf_stretch, std::sqrt(1.0 / scale), 1e-12);
}

TEST(ParametrizationMeasures, MirroredChartsAreNotFlipped) {
    const Square square;
    const ParametrizationMeasures m =
        measure(square, [](const Vec2& p) { return Vec2(-p.x(), p.y()); });
    expect_isometric(m);
    EXPECT_EQ(m.flipped_faces_number, 0);
}

TEST(ParametrizationMeasures, ChartsAreComparedAtTheirOwnScale) {
    Square square;
    const mesh::RawMesh two =
        shapes::join(square.raw, shapes::moved(square.raw, 1.0, Vec3(3, 0, 0)));
    const Mesh mesh = checks::gated(two);
    CornerUv uv = square.plane;
    for (const Vec2& p : square.plane)
        uv.push_back(2.0 * p + Vec2(3.0, 0.0));
    const ParametrizationMeasures m = measure_parametrization(mesh, uv);
    EXPECT_EQ(m.charts_number, 2);
    EXPECT_EQ(m.disk_charts_number, 2);
    expect_isometric(m);
    EXPECT_EQ(m.overlapping_faces_number, 0);
    EXPECT_NEAR(m.packing_efficiency, 5.0 / (5.0 * 2.0), 1e-12);
}

TEST(ParametrizationMeasures, OneCutInTheCoordinatesMakesTwoCharts) {
    const Square square(14.0); // cells of 2
    const auto cut_at = [](const Vec2& centre) { return centre.x() > 6.0; };
    CornerUv uv = square.plane;
    for (std::size_t f = 0; f < square.raw.faces.size(); ++f) {
        const Vec2 centre = (uv[3 * f] + uv[3 * f + 1] + uv[3 * f + 2]) / 3.0;
        if (cut_at(centre))
            for (std::size_t k = 0; k < 3; ++k)
                uv[3 * f + k] += Vec2(30.0, 0.0);
    }
    ParametrizationMeasures m = measure_parametrization(square.mesh, uv);
    EXPECT_EQ(m.charts_number, 2);
    EXPECT_NEAR(m.seam_length, 14.0, 1e-9); // model units
    EXPECT_EQ(m.overlapping_faces_number, 0);
    expect_isometric(m);
    // Pushed together until a column of cells of each part overlaps one of the other.
    for (Vec2& p : uv)
        p.x() -= p.x() > 20.0 ? 32.0 : 0.0;
    m = measure_parametrization(square.mesh, uv);
    EXPECT_EQ(m.charts_number, 2);
    EXPECT_EQ(m.overlapping_faces_number, 2 * 2 * cells);
}

TEST(ParametrizationMeasures, FlippedFacesAreCountedAgainstMostOfTheirChart) {
    const Square square;
    for (const double mirror : {1.0, -1.0}) {
        const Vec2 inner(3.0 / cells, 3.0 / cells); // a vertex with six faces
        const ParametrizationMeasures m = measure(square, [&](const Vec2& p) {
            Vec2 q = (p - inner).norm() < 1e-9 ? Vec2(p + Vec2(1.3, 0.1) / cells) : p;
            q.x() *= mirror;
            return q;
        });
        // The vertex crosses two edges of its star.
        CornerUv uv = square.map([&](const Vec2& p) {
            return (p - inner).norm() < 1e-9 ? Vec2(p + Vec2(1.3, 0.1) / cells) : p;
        });
        Index expected = 0;
        for (const Face f : square.mesh.all_faces())
            expected += plane::uv_area(uv, f) <= 0.0 ? 1 : 0;
        EXPECT_GE(expected, 1);
        EXPECT_EQ(m.flipped_faces_number, expected);
        EXPECT_GT(m.overlapping_faces_number, 0);
    }
}

TEST(ParametrizationMeasures, TheLargestStretchIsThatOfFacesThatAreNotFlipped) {
    // A vertex goes just past its neighbour: two faces are turned over and nearly flat.
    const Square square;
    const Vec2 inner(3.0 / cells, 3.0 / cells);
    const ParametrizationMeasures m = measure(square, [&](const Vec2& p) {
        return (p - inner).norm() < 1e-9 ? Vec2(p + Vec2(1.02, 0.0) / cells) : p;
    });
    EXPECT_EQ(m.flipped_faces_number, 2);
    EXPECT_LT(m.linf_stretch, 3.0);
    EXPECT_GT(m.l2_stretch, 3.0); // which counts all
}

TEST(ParametrizationMeasures, CollapsedFacesAreCountedAndLeftOut) {
    const Square square;
    CornerUv uv = square.plane;
    for (std::size_t k = 0; k < 3; ++k)
        uv[3 * 20 + k] = uv[3 * 20]; // one face becomes a point, and so a chart of its own
    const ParametrizationMeasures m = measure_parametrization(square.mesh, uv);
    EXPECT_EQ(m.flipped_faces_number, 1);
    EXPECT_TRUE(std::isfinite(m.l2_stretch));
    expect_isometric(m);
    // All of it in one point.
    const ParametrizationMeasures none =
        measure(square, [](const Vec2&) { return Vec2(0.3, 0.3); });
    EXPECT_EQ(none.flipped_faces_number, square.mesh.face_count());
    EXPECT_EQ(none.packing_efficiency, 0.0);
    EXPECT_TRUE(std::isfinite(none.l2_stretch));
}

TEST(ParametrizationMeasures, FacesWithoutAreaOnTheSurfaceAreLeftOut) {
    mesh::RawMesh raw = shapes::grid(3, 3);
    raw.points[5] = raw.points[6];
    const Mesh mesh = mesh::gate_mesh(raw, {-1.0, false}).mesh;
    CornerUv uv;
    for (const Triangle& t : shapes::grid(3, 3).faces)
        for (const Index v : t)
            uv.push_back(shapes::grid(3, 3).points[v].head<2>());
    const ParametrizationMeasures m = measure_parametrization(mesh, uv);
    EXPECT_TRUE(std::isfinite(m.l2_stretch));
    EXPECT_TRUE(std::isfinite(m.max_area_change));
    EXPECT_GT(m.l2_stretch, 1.0);
}

TEST(ParametrizationMeasures, AnUnrolledPrism) {
    const mesh::RawMesh raw = shapes::cylinder_tube(24, 3, 1.0, 2.1);
    const Mesh mesh = checks::gated(raw);
    const double side = 2.0 * std::sin(shapes::pi / 24);
    CornerUv uv;
    for (std::size_t f = 0; f < raw.faces.size(); ++f) {
        const Index column = static_cast<Index>(f / 2) % 24;
        for (const Index v : raw.faces[f]) {
            const Index i = v % 24 == 0 && column == 23 ? 24 : v % 24; // the seam is at 0
            uv.emplace_back(side * i, raw.points[v].z());
        }
    }
    const ParametrizationMeasures m = measure_parametrization(mesh, uv);
    expect_isometric(m);
    EXPECT_EQ(m.charts_number, 1);
    EXPECT_EQ(m.disk_charts_number, 1);
    EXPECT_NEAR(m.seam_length, 2.1, 1e-9);
    EXPECT_EQ(m.flipped_faces_number, 0);
    EXPECT_EQ(m.overlapping_faces_number, 0);
    EXPECT_NEAR(m.packing_efficiency, 1.0, 1e-9);
}

TEST(ParametrizationMeasures, AFlatAnnulusIsADiskWithAHole) {
    const mesh::RawMesh raw = shapes::annulus(20, 2, 1.0, 2.0);
    CornerUv uv;
    for (const Triangle& t : raw.faces)
        for (const Index v : t)
            uv.push_back(raw.points[v].head<2>());
    const ParametrizationMeasures m = measure_parametrization(checks::gated(raw), uv);
    EXPECT_EQ(m.charts_number, 1);
    EXPECT_EQ(m.disk_charts_number, 0);
    EXPECT_EQ(m.holed_charts_number, 1);
    expect_isometric(m);
}

} // namespace
} // namespace devseg::metrics
