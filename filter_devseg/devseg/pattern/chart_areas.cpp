#include "devseg/pattern/chart_areas.h"

#include <algorithm>
#include <cmath>

#include "devseg/base/errors.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Of the root of the whole area: narrower charts are degenerate faces that some atlas gave a chart
// of their own. On a sheet of a square metre they are 1 µm wide.
constexpr double narrow_chart = 1e-6;

// A chart that covers less than this share of its own area has collapsed in the plane.
constexpr double collapsed_chart = 1e-6;

// Charts that have collapsed are left out up to this share of the model: makers of atlases
// give faces that they cannot unfold one point.
constexpr double left_out_share = 1e-3;

// A piece may lose this share of its area to folds before that is reported.
constexpr double fold_tolerance = 1e-3;

bool is_narrow(double area, double edge, double total) {
    const double width = narrow_chart * std::sqrt(total);
    return area <= width * std::max(edge, width);
}

} // namespace

bool ChartAreas::is_crumb(std::size_t chart) const {
    return is_narrow(surface[chart], surface_edge[chart], surface_total) &&
           is_narrow(std::abs(plane[chart]), plane_edge[chart], plane_total);
}

std::vector<double> ChartAreas::worth_cutting() const {
    std::vector<double> result = plane;
    for (std::size_t c = 0; c < result.size(); ++c)
        if (is_crumb(c))
            result[c] = 0.0;
    return result;
}

ChartAreas measure_charts(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts,
                          double scale) {
    ChartAreas areas;
    areas.scale = scale;
    areas.surface.assign(at(charts.count), 0.0);
    areas.plane.assign(at(charts.count), 0.0);
    areas.covered.assign(at(charts.count), 0.0);
    areas.surface_edge.assign(at(charts.count), 0.0);
    areas.plane_edge.assign(at(charts.count), 0.0);
    areas.surface_total = mesh.total_area;
    for (const Face f : mesh.all_faces()) {
        const double area = plane::uv_area(uv, f);
        areas.surface[charts.chart[f]] += mesh.face_areas[f];
        areas.plane[charts.chart[f]] += area;
        areas.covered[charts.chart[f]] += std::abs(area);
        for (const HalfEdge h : half_edges_of(f)) {
            double& longest = areas.surface_edge[charts.chart[f]];
            double& flat = areas.plane_edge[charts.chart[f]];
            longest = std::max(longest, mesh.edge_length(h));
            flat = std::max(flat, (uv[Mesh::next(h)] - uv[h]).norm());
        }
        areas.plane_total += std::abs(area);
    }
    if (!(areas.plane_total > 0.0) || !std::isfinite(areas.plane_total))
        throw InvalidMesh(
            std::string("expected texture coordinates that cover an area, found ") +
            (areas.plane_total > 0.0 ? "some that are too large to measure" : "none") +
            flatten_first);
    return areas;
}

// Charts without area in the plane cannot be cut; crumbs need not be. Small ones are left
// out for that.
void check_charts(const atlas::ChartMap& charts, ChartAreas& areas) {
    const double scale = areas.scale;
    std::vector<std::uint8_t> is_bad(at(charts.count), 0);
    Index count = 0;
    double lost = 0.0;
    for (std::size_t c = 0; c < is_bad.size(); ++c) {
        areas.crumbs += areas.is_crumb(c) ? 1 : 0;
        if (!areas.is_crumb(c) &&
            !(std::abs(areas.plane[c]) * scale * scale >= collapsed_chart * areas.surface[c])) {
            is_bad[c] = 1;
            ++count;
            lost += areas.surface[c];
        }
    }
    if (lost <= left_out_share * areas.surface_total) {
        for (std::size_t c = 0; c < is_bad.size(); ++c)
            if (is_bad[c] != 0)
                areas.plane[c] = 0.0;
        areas.left_out = count;
        return;
    }
    std::vector<Index> faces;
    for (std::size_t f = 0; f < charts.chart.size(); ++f)
        if (is_bad[charts.chart[f]] != 0)
            faces.push_back(static_cast<Index>(f));
    throw InvalidMesh("expected charts that lie flat in the texture coordinates, found " +
                          std::to_string(count) + " of " + std::to_string(charts.count) +
                          (count == 1 ? " that covers" : " that cover") + " no area" +
                          flatten_first,
                      faces);
}

void note_folds(Pattern& pattern, const ChartAreas& areas) {
    if (areas.left_out > 0)
        pattern.notes.push_back(
            std::to_string(areas.left_out) +
            (areas.left_out == 1 ? " small chart covers" : " small charts cover") +
            " no area in the texture coordinates: left out "
            "('Charts: Flatten' unfolds all)");
    if (areas.crumbs > 0)
        pattern.notes.push_back(std::to_string(areas.crumbs) +
                                (areas.crumbs == 1 ? " chart is" : " charts are") +
                                " narrower than a millionth of the model: left out");
    const auto is_folded = [&](const PatternPiece& piece) {
        const double whole = areas.covered[piece.chart];
        return whole - std::abs(areas.plane[piece.chart]) > fold_tolerance * whole;
    };
    const auto count = std::count_if(pattern.pieces.begin(), pattern.pieces.end(), is_folded);
    if (count > 0)
        pattern.notes.push_back(std::to_string(count) + " of " +
                                std::to_string(pattern.pieces.size()) +
                                (count == 1 ? " pieces folds" : " pieces fold") +
                                " over in the texture coordinates: the outline does not enclose "
                                "the whole area ('Charts: Flatten' folds nothing)");
}

} // namespace devseg::pattern
