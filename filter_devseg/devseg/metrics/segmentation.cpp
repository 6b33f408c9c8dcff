#include "devseg/metrics/segmentation.h"

#include <algorithm>

#include "devseg/atlas/holes.h"
#include "devseg/metrics/conic_proxy.h"
#include "devseg/metrics/gauss_area.h"

namespace devseg::metrics {

namespace {

// [YGZS05, section 4]: the threshold of all its examples.
constexpr double crease_angle = 45.0 * pi / 180.0;

double share_of_creases(const Mesh& mesh, const std::vector<std::uint8_t>& crease,
                        const std::vector<std::uint8_t>& seam) {
    double all = 0.0;
    double cut = 0.0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (crease[h] == 0)
            continue;
        all += mesh.edge_length(h);
        cut += seam[h] != 0 ? mesh.edge_length(h) : 0.0;
    }
    return all > 0.0 ? cut / all : 1.0;
}

} // namespace

SegmentationMeasures measure_segmentation(const Mesh& mesh, const atlas::ChartMap& charts) {
    SegmentationMeasures result;
    result.charts_number = charts.count;
    result.seam_length = seam_length(mesh, charts);
    for (const atlas::ChartSurface& surface : atlas::extract_charts(mesh, charts)) {
        if (surface.is_disk())
            ++result.disk_charts_number;
        else if (atlas::is_sound(mesh, surface))
            ++result.holed_charts_number;
        NormalMoments moments;
        for (const Face f : surface.face)
            moments.add(mesh.face_areas[f], mesh.face_normals[f]);
        const ConicProxy proxy = fit_conic(moments);
        for (const Face f : surface.face)
            result.max_fitting_error =
                std::max(result.max_fitting_error, proxy.fitting_error(mesh.face_normals[f]));
        result.largest_chart_area_share =
            std::max(result.largest_chart_area_share, moments.area / mesh.total_area);
    }
    const GaussAreas areas = compute_gauss_areas(mesh, crease_angle);
    const std::vector<double> sums = chart_gauss_areas(mesh, areas, charts.chart, charts.count);
    result.gauss_area_std = standard_deviation(sums);
    for (const double sum : sums)
        result.gauss_area_mean += sum / static_cast<double>(charts.count);
    result.crease_share = share_of_creases(mesh, areas.crease, charts.seam);
    return result;
}

double seam_length(const Mesh& mesh, const atlas::ChartMap& charts) {
    double sum = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (charts.seam[h] != 0 && h < mesh.twin[h])
            sum += mesh.edge_length(h);
    return sum * mesh.unit_length;
}

} // namespace devseg::metrics
