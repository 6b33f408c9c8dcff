#include "devseg/flatten/slivers.h"

#include <algorithm>
#include <map>
#include <utility>

#include "devseg/develop/unfold.h"
#include "devseg/flatten/map_tools.h"
#include "devseg/flatten/one_chart.h"
#include "devseg/flatten/rest_shape.h"

namespace devseg {

namespace {

constexpr double sliver_share = 0.01; // of the mesh's area: smaller parts are slivers
// What a joined map may lose: excess of its energy, as a share of the mesh's area, and the stretch
// of its worst face, which may in any case be as high as that of the parts.
constexpr double allowed_excess = 2e-4;
constexpr double allowed_stretch = 1.5;

double area_of(const Mesh& mesh, const FlatChart& chart) {
    double area = 0.0;
    for (const Index f : chart.surface.face)
        area += mesh.face_areas[at(f)];
    return area;
}

double excess_of(const Mesh& mesh, const FlatChart& chart) {
    return (chart.energy - 1.0) * area_of(mesh, chart);
}

double largest_stretch(const Mesh& mesh, const FlatChart& chart) {
    const FlatteningProblem problem = make_flattening_problem(mesh, chart.surface);
    double largest = 1.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        largest = std::max(largest, face_stretch(problem, chart.uv, f));
    return largest;
}

// Charts beside this one, those with the longest common border first.
std::vector<Index> neighbours(const Mesh& mesh, const FlattenResult& result, Index chart) {
    std::map<Index, double> border;
    for (const Index f : result.flat[at(chart)].surface.face)
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            const Index twin = mesh.twin[at(h)];
            if (twin >= 0 && result.charts.chart[at(twin / 3)] != chart)
                border[result.charts.chart[at(twin / 3)]] += mesh.edge_length(h);
        }
    std::vector<std::pair<double, Index>> order;
    for (const auto& [other, length] : border)
        order.emplace_back(-length, other);
    std::sort(order.begin(), order.end());
    std::vector<Index> charts;
    for (const auto& entry : order)
        charts.push_back(entry.second);
    return charts;
}

// The two charts as one, in `charts` as well as in `flat`.
void replace(const Mesh& mesh, Index part, Index other, std::vector<std::uint8_t> seam,
             FlatChart joined, FlattenResult& result) {
    std::vector<Index> label = result.charts.chart;
    for (const Index f : result.flat[at(part)].surface.face)
        label[at(f)] = other;
    result.charts = make_chart_map(mesh, label, seam, true);
    std::vector<FlatChart> flat(at(result.charts.count));
    std::vector<std::uint8_t> filled(flat.size(), 0);
    for (std::size_t f = 0; f < label.size(); ++f) {
        const std::size_t c = at(result.charts.chart[f]);
        if (filled[c]++ == 0)
            flat[c] = std::move(label[f] == other ? joined : result.flat[at(label[f])]);
        filled[c] = 1;
    }
    result.flat = std::move(flat);
}

bool try_to_join(const Mesh& mesh, FlattenMethod method, double tolerance, Index part, Index other,
                 FlattenResult& result, const Progress& progress) {
    const FlatChart& small = result.flat[at(part)];
    const FlatChart& large = result.flat[at(other)];
    std::vector<std::uint8_t> seam = result.charts.seam;
    for (const Index f : small.surface.face)
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            const Index twin = mesh.twin[at(h)];
            if (twin >= 0 && result.charts.chart[at(twin / 3)] == other)
                seam[at(h)] = seam[at(twin)] = 0;
        }
    std::vector<Index> faces = large.surface.face;
    faces.insert(faces.end(), small.surface.face.begin(), small.surface.face.end());
    std::sort(faces.begin(), faces.end());
    FlatChart joined;
    joined.surface = extract_surface(mesh, std::move(faces), seam);
    if (!joined.surface.is_disk())
        return false;
    // What can be folded of paper stays so.
    if ((small.developed || large.developed) &&
        !unfold(make_flattening_problem(mesh, joined.surface), joined.surface.twin))
        return false;
    if (!flatten_one(mesh, method, tolerance, joined, progress).empty())
        return false;
    const double before = excess_of(mesh, small) + excess_of(mesh, large);
    const double worst =
        std::max({allowed_stretch, largest_stretch(mesh, small), largest_stretch(mesh, large)});
    if (excess_of(mesh, joined) > before + allowed_excess * mesh.total_area ||
        largest_stretch(mesh, joined) > worst)
        return false;
    replace(mesh, part, other, std::move(seam), std::move(joined), result);
    return true;
}

} // namespace

void hand_over_slivers(const Mesh& mesh, FlattenMethod method, double tolerance,
                       FlattenResult& result, Progress& progress) {
    std::vector<std::pair<double, Index>> slivers; // (area, first face)
    for (const FlatChart& chart : result.flat) {
        const double area = area_of(mesh, chart);
        if (chart.cut_off && area < sliver_share * mesh.total_area)
            slivers.emplace_back(area, chart.surface.face.front());
    }
    std::sort(slivers.begin(), slivers.end());
    for (const auto& entry : slivers) {
        const Index part = result.charts.chart[at(entry.second)];
        for (const Index other : neighbours(mesh, result, part)) {
            progress.check();
            if (try_to_join(mesh, method, tolerance, part, other, result, progress))
                break;
        }
    }
}

} // namespace devseg
