#include "devseg/metrics/segmentation.h"

#include <algorithm>

#include "devseg/segment/conic_proxy.h"
#include "devseg/segment/gauss_area.h"

namespace devseg {

namespace {

// [YGZS05, section 4]: the threshold of all its examples.
constexpr double crease_angle = 45.0 * 3.14159265358979323846 / 180.0;

} // namespace

SegmentationMeasures measure_segmentation(const Mesh& mesh, const ChartMap& charts) {
    SegmentationMeasures result;
    result.charts_number = charts.count;
    result.seam_length = seam_length(mesh, charts);
    for (const ChartSurface& surface : extract_charts(mesh, charts)) {
        result.disk_charts_number += surface.is_disk() ? 1 : 0;
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
    result.gauss_area_std = standard_deviation(chart_gauss_areas(
        mesh, compute_gauss_areas(mesh, crease_angle), charts.chart, charts.count));
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
