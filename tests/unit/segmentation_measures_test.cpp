#include "devseg/metrics/segmentation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg {
namespace {

using shapes::pi;

SegmentationMeasures measure(const Mesh& mesh, const std::vector<Index>& labels) {
    return measure_segmentation(mesh, make_chart_map(mesh, labels, {}, false));
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

TEST(SegmentationMeasures, GaussBonnetOnASphereOfTwoCharts) {
    // One chart is a single face without inner vertices: 0. The other one holds the angle defects
    // of all vertices that are not on its border, of a total of 4π.
    const Mesh mesh = checks::gated(shapes::sphere(2));
    std::vector<Index> labels(mesh.faces.size(), 0);
    labels[0] = 1;
    std::vector<double> angle_sum(mesh.points.size(), 0.0);
    for (const Triangle& t : mesh.faces)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 a = mesh.points[at(t[(k + 1) % 3])] - mesh.points[at(t[k])];
            const Vec3 b = mesh.points[at(t[(k + 2) % 3])] - mesh.points[at(t[k])];
            angle_sum[at(t[k])] += std::acos(a.normalized().dot(b.normalized()));
        }
    double expected = 4.0 * pi;
    for (const Index v : mesh.faces[0])
        expected -= 2.0 * pi - angle_sum[at(v)];
    const SegmentationMeasures m = measure(mesh, labels);
    // The standard deviation of {0, x} is x / 2.
    EXPECT_NEAR(m.gauss_area_std, 0.5 * expected, 1e-9);
    EXPECT_EQ(m.disk_charts_number, 2);
    EXPECT_NEAR(m.largest_chart_area_share, 1.0 - mesh.face_areas[0] / mesh.total_area, 1e-12);
}

TEST(SegmentationMeasures, CurvatureOfBothSignsAddsUp) {
    // A saddle and a peak do not cancel.
    RawMesh raw = shapes::grid(8, 8);
    for (Vec3& p : raw.points)
        p.z() = std::sin(4.0 * p.x()) * std::sin(4.0 * p.y());
    const Mesh mesh = checks::gated(raw);
    std::vector<Index> labels(mesh.faces.size(), 0);
    labels[0] = 1;
    std::vector<double> defect(mesh.points.size(), 2.0 * pi);
    for (const Triangle& t : mesh.faces)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 a = mesh.points[at(t[(k + 1) % 3])] - mesh.points[at(t[k])];
            const Vec3 b = mesh.points[at(t[(k + 2) % 3])] - mesh.points[at(t[k])];
            defect[at(t[k])] -= std::acos(a.normalized().dot(b.normalized()));
        }
    for (const Index v : mesh.faces[0])
        defect[at(v)] = 0.0;
    double sum = 0.0;
    double net = 0.0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        const Index column = v % 9;
        const Index row = v / 9;
        if (column == 0 || row == 0 || column == 8 || row == 8)
            continue;
        sum += std::abs(defect[at(v)]);
        net += defect[at(v)];
    }
    EXPECT_GT(sum, std::abs(net) + 0.1);
    EXPECT_NEAR(measure(mesh, labels).gauss_area_std, 0.5 * sum, 1e-9);
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
    const ChartMap charts = checks::components_cut_to_disks(mesh);
    const SegmentationMeasures m = measure_segmentation(mesh, charts);
    EXPECT_EQ(m.charts_number, 1);
    EXPECT_EQ(m.disk_charts_number, 1);
    EXPECT_NEAR(m.seam_length, 2.0, 1e-9);
    EXPECT_EQ(measure_segmentation(mesh, checks::components(mesh)).disk_charts_number, 0);
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
} // namespace devseg
