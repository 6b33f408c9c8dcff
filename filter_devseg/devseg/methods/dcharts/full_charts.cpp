#include "devseg/methods/dcharts/full_charts.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "devseg/atlas/fragments.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/borders.h"

namespace devseg::dcharts {

namespace {

// What faces fit in each chart: the proxies of all patches that it was joined from.
growth::ChartProxies proxies_of_charts(const Mesh& mesh, const Draft& draft,
                                       const std::vector<Index>& patch) {
    const Index patches = 1 + *std::max_element(patch.begin(), patch.end());
    const std::vector<metrics::ConicProxy> proxies = metrics::fit_conics(mesh, patch, patches);
    growth::ChartProxies result(draft.faces.size());
    std::set<std::pair<Index, Index>> seen; // few of all pairs
    for (std::size_t f = 0; f < patch.size(); ++f)
        if (seen.emplace(draft.chart[f], patch[f]).second)
            result[draft.chart[f]].push_back(proxies[patch[f]]);
    return result;
}

// A strip of about one edge of the coarse surface is too narrow to change the shape of a chart by
// much.
void straighten(const Mesh& mesh, const Mesh& coarse, const Draft& draft,
                const std::vector<Index>& patch, double max_fitting_error,
                Straightening straightening, std::vector<Index>& chart, Progress& progress) {
    const bool fitting = straightening != Straightening::none && &mesh != &coarse;
    const bool smooth = straightening == Straightening::smooth;
    if (!fitting && !smooth)
        return;
    const growth::ChartProxies proxies = proxies_of_charts(coarse, draft, patch);
    const double ratio = static_cast<double>(mesh.face_count()) / coarse.face_count();
    const int edge = static_cast<int>(std::sqrt(ratio)); // of the coarse surface, in faces
    if (fitting)
        growth::straighten_borders(mesh, proxies, max_fitting_error, 2 + 2 * edge, chart, progress);
    if (smooth)
        growth::straighten_borders(mesh, proxies, infinite, 1 + edge, chart, progress);
}

// The cuts that joins left inside charts (3 #F): those of the coarse surface along the shortest
// paths between the same vertices.
std::vector<std::uint8_t> left_cuts(const Mesh& mesh,
                                    const std::optional<mesh::CoarseMesh>& decimation,
                                    const Draft& draft, const std::vector<Index>& chart,
                                    const Progress& progress) {
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    const auto mark = [&](HalfEdge h) {
        const Face g = mesh.across(h);
        if (g >= 0 && chart[face_of(h)] == chart[g])
            seam[h] = seam[mesh.twin[h]] = 1;
    };
    std::optional<Buckets<HalfEdge>> leaving;
    graph::ShortestPaths<> paths(mesh.points.size());
    for (const HalfEdge cut : draft.left) {
        if (draft.seam[cut] == 0) // healed since
            continue;
        if (!decimation) {
            mark(cut);
            continue;
        }
        if (!leaving)
            leaving = make_buckets<HalfEdge>(mesh.vertex_count(), [&](auto put) {
                for (const HalfEdge h : mesh.all_half_edges())
                    put(mesh.origin(h), h);
            });
        const Vertex from = decimation->vertex[decimation->mesh.origin(cut)];
        const Vertex to = decimation->vertex[decimation->mesh.target(cut)];
        paths.clear();
        paths.add_source(from);
        paths.run(
            [&](Vertex v, double distance) {
                for (const HalfEdge h : (*leaving)[v])
                    if (mesh.twin[h] >= 0)
                        paths.reach(mesh.target(h), distance + mesh.edge_length(h), h);
                return v != to;
            },
            progress);
        for (Vertex v = to; v != from && paths.step[v] >= 0; v = mesh.origin(paths.step[v]))
            mark(paths.step[v]);
    }
    return seam;
}

} // namespace

std::optional<mesh::CoarseMesh> decimate(const Mesh& mesh, bool creased, Index charts,
                                         Progress& progress) {
    const Index wanted = std::max(creased ? tuning.decimated_creased_faces : tuning.decimated_faces,
                                  tuning.faces_per_chart * charts);
    if (mesh.face_count() <= tuning.worth_decimation * wanted)
        return {};
    return mesh::coarsen_in_parallel(mesh, wanted, progress);
}

DevelopableCharts transfer(const Mesh& mesh, const std::optional<mesh::CoarseMesh>& decimation,
                           const Draft& draft, const std::vector<Index>& patch,
                           double max_fitting_error, Straightening straightening,
                           Progress& progress) {
    DevelopableCharts result;
    result.chart =
        decimation ? mesh::refine_labels(mesh, *decimation, draft.chart, progress) : draft.chart;
    straighten(mesh, decimation ? decimation->mesh : mesh, draft, patch, max_fitting_error,
               straightening, result.chart, progress);
    result.seam = draft.seam;
    result.darts = static_cast<Index>(draft.tips.size());
    if (decimation || straightening == Straightening::smooth) {
        mesh::keep_regions_whole(mesh, tuning.least_chart, result.chart);
        result.chart = atlas::absorb_fragments(mesh, result.chart, tuning.least_chart);
        progress.check();
        std::vector<Index> tips = draft.tips;
        for (Index& tip : tips)
            tip = decimation ? decimation->vertex[tip] : tip;
        result.seam = left_cuts(mesh, decimation, draft, result.chart, progress);
        result.darts = cut_darts_to(mesh, result.chart, tips, result.seam);
    }
    progress.check();
    // Borders that have moved may meet cuts and take a chart apart.
    result.chart = atlas::make_chart_map(mesh, result.chart, result.seam, true).chart;
    progress.check();
    return result;
}

} // namespace devseg::dcharts
