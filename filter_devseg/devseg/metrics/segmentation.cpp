#include "devseg/metrics/segmentation.h"

#include <algorithm>
#include <cmath>

#include "devseg/segment/conic_proxy.h"

namespace devseg {

namespace {

constexpr double pi = 3.14159265358979323846;

double angle_at_corner(const Mesh& mesh, Index h) {
    const Vec3& corner = mesh.points[at(mesh.origin(h))];
    const Vec3 a = mesh.points[at(mesh.target(h))] - corner;
    const Vec3 b = mesh.points[at(mesh.origin(Mesh::previous(h)))] - corner;
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Σ |2π − angle sum| over the vertices inside the chart: 0 for a developable chart.
double absolute_curvature(const Mesh& mesh, const ChartSurface& surface) {
    std::vector<double> defect(surface.vertex.size(), 2.0 * pi);
    for (Index h = 0; h < 3 * surface.face_count(); ++h)
        defect[at(surface.origin(h))] -= angle_at_corner(mesh, surface.mesh_half_edge(h));
    for (const std::vector<Index>& loop : surface.loops)
        for (const Index h : loop)
            defect[at(surface.origin(h))] = 0.0;
    double sum = 0.0;
    for (const double d : defect)
        sum += std::abs(d);
    return sum;
}

double standard_deviation(const std::vector<double>& values) {
    double mean = 0.0;
    for (const double v : values)
        mean += v / static_cast<double>(values.size());
    double variance = 0.0;
    for (const double v : values)
        variance += (v - mean) * (v - mean) / static_cast<double>(values.size());
    return std::sqrt(variance);
}

} // namespace

SegmentationMeasures measure_segmentation(const Mesh& mesh, const ChartMap& charts) {
    SegmentationMeasures result;
    result.charts_number = charts.count;
    result.seam_length = seam_length(mesh, charts);
    std::vector<double> curvature;
    for (const ChartSurface& surface : extract_charts(mesh, charts)) {
        result.disk_charts_number += surface.is_disk() ? 1 : 0;
        curvature.push_back(absolute_curvature(mesh, surface));
        NormalMoments moments;
        for (const Index f : surface.face)
            moments.add(mesh.face_areas[at(f)], mesh.face_normals[at(f)]);
        const ConicProxy proxy = fit_conic(moments);
        for (const Index f : surface.face)
            result.max_fitting_error =
                std::max(result.max_fitting_error, proxy.fitting_error(mesh.face_normals[at(f)]));
        result.largest_chart_area_share =
            std::max(result.largest_chart_area_share, moments.area / mesh.total_area);
    }
    result.gauss_area_std = standard_deviation(curvature);
    return result;
}

double seam_length(const Mesh& mesh, const ChartMap& charts) {
    double sum = 0.0;
    for (Index h = 0; h < mesh.half_edge_count(); ++h)
        if (charts.seam[at(h)] != 0 && h < mesh.twin[at(h)])
            sum += mesh.edge_length(h);
    return sum * mesh.unit_length;
}

} // namespace devseg
