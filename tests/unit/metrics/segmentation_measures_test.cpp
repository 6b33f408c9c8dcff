#include "devseg/metrics/segmentation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::metrics {
namespace {

using shapes::pi;

SegmentationMeasures measure(const Mesh& mesh, const std::vector<Index>& labels) {
    return measure_segmentation(mesh, atlas::make_chart_map(mesh, labels, {}, false));
}

std::vector<Index> labels_of(const Mesh& mesh, const std::function<Index(const Vec3&)>& label) {
    std::vector<Index> labels;
    for (const Vec3& centre : mesh.face_centers)
        labels.push_back(label(centre));
    return labels;
}

TEST(SegmentationMeasures, ASquareInTwoHalves) {
    for (const double size : {1e-3, 1.0, 250.0}) {
        const Mesh mesh = checks::gated(shapes::grid(4, 4, size, size));
        const SegmentationMeasures m =
            measure(mesh, labels_of(mesh, [](const Vec3& c) { return c.x() > 0.0 ? 1 : 0; }));
        EXPECT_EQ(m.charts_number, 2);
        EXPECT_EQ(m.disk_charts_number, 2);
        EXPECT_NEAR(m.seam_length, size, 1e-9 * size); // model units; the border is no seam
        EXPECT_NEAR(m.largest_chart_area_share, 0.5, 1e-12);
        EXPECT_NEAR(m.max_fitting_error, 0.0, 1e-12);
        EXPECT_NEAR(m.gauss_area_std, 0.0, 1e-9);
    }
}

TEST(SegmentationMeasures, GaussAreasOfASphereOfTwoCharts) {
    // On a sphere with exact normals a face sweeps the spherical triangle above it.
    const Mesh mesh = checks::gated(shapes::sphere(3));
    std::vector<Index> labels(mesh.faces.size(), 0);
    labels[0] = 1;
    std::array<Vec3, 3> n;
    for (std::size_t k = 0; k < 3; ++k)
        n[k] = mesh.points[mesh.faces[0][k]].normalized();
    // Girard: the sum of the angles between the planes of the sides, less π.
    double first = -pi;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 a = n[k].cross(n[(k + 1) % 3]).normalized();
        const Vec3 b = n[k].cross(n[(k + 2) % 3]).normalized();
        first += std::acos(a.dot(b));
    }
    // The standard deviation of {a, b} is half their difference.
    EXPECT_NEAR(measure(mesh, labels).gauss_area_std, 0.5 * (4.0 * pi - 2.0 * first), 1e-9);
}

TEST(SegmentationMeasures, CurvatureOfBothSignsAddsUp) {
    // The inner and the outer half of a torus sweep 4π each, of opposite signs.
    const Mesh mesh = checks::gated(shapes::torus(96, 48, 2.0, 0.7));
    std::vector<Index> labels(mesh.faces.size(), 0);
    labels[0] = 1;
    EXPECT_NEAR(measure(mesh, labels).gauss_area_std, 0.5 * 8.0 * pi, 0.02 * 4.0 * pi);
}

TEST(SegmentationMeasures, DevelopableChartsHaveNoErrorOfTheirOwn) {
    const Mesh mesh = checks::gated(shapes::capped_cylinder(24, 5));
    const SegmentationMeasures parts =
        measure(mesh, labels_of(mesh, [&](const Vec3& c) {
                    const double half = 1.0 / mesh.unit_length; // of the height
                    return std::abs(c.z()) < half - 1e-9 ? 0 : c.z() > 0.0 ? 1 : 2;
                }));
    EXPECT_EQ(parts.charts_number, 3);
    EXPECT_EQ(parts.disk_charts_number, 2); // the tube is none
    EXPECT_LT(parts.max_fitting_error, 1e-12);
    EXPECT_NEAR(parts.gauss_area_std, 0.0, 1e-9);
    EXPECT_NEAR(parts.seam_length, 2.0 * 24 * 2.0 * std::sin(pi / 24), 1e-9);
    const SegmentationMeasures whole = measure(mesh, std::vector<Index>(mesh.faces.size(), 0));
    EXPECT_GT(whole.max_fitting_error, 0.1);
}

TEST(SegmentationMeasures, DartsAreCutOpenAndCounted) {
    const Mesh mesh = checks::gated(shapes::cylinder_tube(16, 4, 1.0, 2.0));
    const atlas::ChartMap charts = checks::components_cut_to_disks(mesh);
    const SegmentationMeasures m = measure_segmentation(mesh, charts);
    EXPECT_EQ(m.charts_number, 1);
    EXPECT_EQ(m.disk_charts_number, 1);
    EXPECT_NEAR(m.seam_length, 2.0, 1e-9);
    EXPECT_EQ(measure_segmentation(mesh, checks::components(mesh)).disk_charts_number, 0);
    EXPECT_EQ(measure_segmentation(mesh, checks::components(mesh)).holed_charts_number, 0);
    const Mesh ring = checks::gated(shapes::annulus(16, 2, 1.0, 2.0));
    const SegmentationMeasures flat = measure_segmentation(ring, checks::components(ring));
    EXPECT_EQ(flat.disk_charts_number, 0);
    EXPECT_EQ(flat.holed_charts_number, 1);
}

TEST(SegmentationMeasures, TheLargestErrorIsThatOfTheWorstFace) {
    const Mesh mesh = checks::gated(shapes::cube(1)); // 12 faces, 2 on each side
    const SegmentationMeasures m = measure(mesh, std::vector<Index>(12, 0));
    // The covariance is a multiple of the identity: any axis N, angle π/2, worst error max N_i².
    EXPECT_GE(m.max_fitting_error, 1.0 / 3.0 - 1e-9);
    EXPECT_LE(m.max_fitting_error, 1.0 + 1e-9);
    EXPECT_EQ(m.charts_number, 1);
    EXPECT_EQ(m.disk_charts_number, 0);
    EXPECT_EQ(m.largest_chart_area_share, 1.0);
}

} // namespace
} // namespace devseg::metrics
