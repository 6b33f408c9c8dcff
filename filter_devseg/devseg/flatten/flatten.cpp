#include "devseg/flatten/flatten.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/base/parallel.h"
#include "devseg/flatten/one_chart.h"
#include "devseg/flatten/reattach.h"
#include "devseg/plane/overlap.h"

namespace devseg::flatten {

namespace {

// Flattens the charts with the given numbers; returns the half-edges to cut, per chart.
std::vector<std::vector<Index>> flatten_some(const Mesh& mesh, FlattenMethod method,
                                             double tolerance, std::vector<std::size_t> which,
                                             std::vector<FlatChart>& flat, Progress& progress) {
    // The largest first, so that no core is left with a large chart at the end.
    std::stable_sort(which.begin(), which.end(), [&](std::size_t a, std::size_t b) {
        return flat[a].surface.face.size() > flat[b].surface.face.size();
    });
    std::vector<std::vector<Index>> cuts(flat.size());
    parallel_for(
        static_cast<int>(which.size()),
        [&](int i) {
            const std::size_t c = which[static_cast<std::size_t>(i)];
            progress.check();
            cuts[c] = flatten_one(mesh, method, tolerance, flat[c], progress);
        },
        progress);
    return cuts;
}

// Cuts the charts as asked, and takes over the maps of those that stay as they are. Returns the
// numbers of the others.
std::vector<std::size_t> cut_apart(const Mesh& mesh, const std::vector<std::vector<Index>>& cuts,
                                   FlattenResult& result, Progress& progress) {
    std::vector<Index> old_chart = result.charts.chart;
    std::vector<std::uint8_t> seam = result.charts.seam;
    for (const std::vector<Index>& cut : cuts) {
        result.cuts += cut.empty() ? 0 : 1;
        for (const HalfEdge h : cut)
            seam[h] = seam[mesh.twin[h]] = 1;
    }
    result.charts = atlas::cut_charts_to_disks(
                        mesh, atlas::make_chart_map(mesh, old_chart, seam, true), progress)
                        .charts;
    std::vector<FlatChart> flat;
    std::vector<std::size_t> open;
    for (atlas::ChartSurface& surface : atlas::extract_charts(mesh, result.charts)) {
        const std::size_t old = at(old_chart[surface.face.front()]);
        if (cuts[old].empty()) {
            flat.push_back(std::move(result.flat[old]));
        } else {
            open.push_back(flat.size());
            flat.emplace_back();
            flat.back().surface = std::move(surface);
            flat.back().cut_off = true;
        }
    }
    result.flat = std::move(flat);
    return open;
}

} // namespace

FlattenResult flatten_charts(const Mesh& mesh, const atlas::ChartMap& charts, FlattenMethod method,
                             Progress& progress) {
    FlattenResult result;
    result.charts = charts;
    std::vector<std::size_t> open;
    for (atlas::ChartSurface& surface : atlas::extract_charts(mesh, charts)) {
        open.push_back(result.flat.size());
        result.flat.emplace_back();
        result.flat.back().surface = std::move(surface);
    }
    // Every cut makes charts smaller, and a single face overlaps nothing: this ends.
    const double tolerance = plane::layout_tolerance(std::sqrt(mesh.total_area));
    while (!open.empty()) {
        auto flattening = progress.part(0.75 * progress.left());
        const auto cuts = flatten_some(mesh, method, tolerance, open, result.flat, flattening);
        auto cutting = progress.part(0.1 * progress.left());
        open = cut_apart(mesh, cuts, result, cutting);
    }
    auto handing_over = progress.part(0.3 * progress.left());
    hand_over_slivers(mesh, method, tolerance, result, handing_over);
    auto reattaching = progress.part(progress.left());
    if (result.cuts > 0)
        result.reattached = reattach_parts(mesh, tolerance, result, reattaching);
    return result;
}

} // namespace devseg::flatten
