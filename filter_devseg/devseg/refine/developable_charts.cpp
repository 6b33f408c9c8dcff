#include "devseg/refine/developable_charts.h"

#include <algorithm>
#include <cmath>

#include "devseg/mesh/coarsen.h"
#include "devseg/refine/darts.h"
#include "devseg/refine/merging.h"
#include "devseg/segment/borders.h"
#include "devseg/segment/expansion.h"
#include "devseg/segment/fragments.h"

namespace devseg {

namespace {

constexpr Index coarse_faces = 6000;      // enough to decide where borders run
constexpr Index faces_per_chart = 150;    // of the coarse surface, at least
constexpr double worth_coarsening = 1.25; // faces over those of the coarse surface

// What border is worth against the fitting error of faces. Where creases shape the surface, charts
// should end at them, and more seeds are needed to find all the parts between them, which joining
// reduces again.
constexpr double smooth_length_weight = 0.045;
constexpr double creased_length_weight = 0.015;
constexpr int creased_seeds = 2;
constexpr double bent_cosine = 0.866; // of 30 degrees
constexpr double sharp_cosine = 0.5;  // of 60 degrees
constexpr double sharp_share = 0.6;   // of the bent edges
constexpr double least_creases = 1.0; // over the root of the area

// Of the surface: smaller pieces are slivers that nobody wants to cut out.
constexpr double fragment_share = 0.002;

// Stretch that joined charts may have, from η: at η = 0.01, L2 1.005 and L∞ 1.4.
StretchBounds bounds_from(double merge_threshold) {
    return {1.0 + 0.5 * merge_threshold, 1.0 + 4.0 * std::sqrt(merge_threshold)};
}

// Whether creases, rather than smooth or rough regions, give the surface its shape: then most edges
// that are not smooth are sharp.
bool is_creased(const Mesh& mesh) {
    double bent = 0.0;
    double sharp = 0.0;
    for (Index h = 0; h < mesh.half_edge_count(); ++h) {
        const Index twin = mesh.twin[at(h)];
        if (twin <= h)
            continue;
        const double cosine = mesh.face_normals[at(h / 3)].dot(mesh.face_normals[at(twin / 3)]);
        bent += cosine < bent_cosine ? mesh.edge_length(h) : 0.0;
        sharp += cosine < sharp_cosine ? mesh.edge_length(h) : 0.0;
    }
    return sharp > least_creases * std::sqrt(mesh.total_area) && sharp > sharp_share * bent;
}

struct Pieces {
    std::vector<Index> patch;       // #F: charts before joining
    std::vector<Index> chart;       // #F
    std::vector<std::uint8_t> seam; // 3 #F
    std::vector<Index> tips;        // vertices where darts end
};

Pieces decide(const Mesh& mesh, const DevelopableChartsOptions& options, DevelopableCharts& result,
              Progress& progress) {
    const bool creased = is_creased(mesh);
    DChartsOptions growing = options;
    if (creased && options.merge_charts)
        growing.charts_number = std::min(creased_seeds * options.charts_number, mesh.face_count());
    const DChartsResult grown = segment_dcharts(mesh, growing, progress);
    result.rounds = grown.rounds;
    result.converged = grown.converged;
    result.hole_charts = grown.hole_charts;
    Pieces pieces;
    pieces.patch = grown.chart;
    if (options.straighten_boundaries) {
        progress.begin_phase("straightening borders", 0.1);
        ExpansionOptions expansion;
        expansion.max_fitting_error = options.max_fitting_error;
        expansion.length_weight = creased ? creased_length_weight : smooth_length_weight;
        relabel_by_expansion(mesh, grown.proxies, expansion, pieces.patch, progress);
    }
    pieces.patch = absorb_fragments(mesh, pieces.patch, fragment_share);
    pieces.chart = pieces.patch;
    pieces.seam.assign(mesh.twin.size(), 0);
    if (!options.merge_charts && !options.add_darts)
        return pieces;

    progress.begin_phase("trying charts", 0.05);
    Draft draft = make_draft(mesh, pieces.chart, progress);
    if (options.merge_charts) {
        progress.begin_phase("joining charts", 0.3);
        MergeOptions merging;
        merging.chart = bounds_from(options.merge_threshold);
        result.joins = merge_charts(mesh, merging, draft, progress);
    }
    if (options.add_darts) {
        progress.begin_phase("cutting darts", 0.1);
        DartOptions darts;
        darts.chart = bounds_from(options.merge_threshold);
        cut_darts(mesh, darts, draft, progress);
    }
    pieces.chart = draft.chart;
    pieces.seam = draft.seam;
    pieces.tips = draft.tips;
    return pieces;
}

// What faces fit in each chart: the proxies of all patches that it was joined from.
ChartProxies proxies_of_charts(const Mesh& mesh, const Pieces& pieces) {
    const Index patches = 1 + *std::max_element(pieces.patch.begin(), pieces.patch.end());
    const std::vector<ConicProxy> proxies = fit_conics(mesh, pieces.patch, patches);
    ChartProxies result(at(1 + *std::max_element(pieces.chart.begin(), pieces.chart.end())));
    std::vector<std::uint8_t> seen(proxies.size(), 0);
    for (std::size_t f = 0; f < pieces.patch.size(); ++f)
        if (seen[at(pieces.patch[f])]++ == 0)
            result[at(pieces.chart[f])].push_back(proxies[at(pieces.patch[f])]);
        else
            seen[at(pieces.patch[f])] = 1;
    return result;
}

} // namespace

DevelopableCharts segment_developable_charts(const Mesh& mesh,
                                             const DevelopableChartsOptions& options,
                                             Progress& progress) {
    check_options(mesh, options);
    DevelopableCharts result;
    progress.begin_phase("coarsening", 0.2);
    const Index wanted = std::max(coarse_faces, faces_per_chart * options.charts_number);
    const bool is_large = mesh.face_count() > worth_coarsening * wanted;
    if (!is_large) {
        Pieces pieces = decide(mesh, options, result, progress);
        result.chart = std::move(pieces.chart);
        result.seam = std::move(pieces.seam);
        result.darts = static_cast<Index>(pieces.tips.size());
    } else {
        CoarseSurface surface = coarsen(mesh.points, mesh.faces, mesh.twin, wanted, progress);
        const CoarseMesh coarse = extract_coarse_mesh(mesh, surface);
        const Pieces pieces = decide(coarse.mesh, options, result, progress);
        std::vector<Index> label(mesh.faces.size(), -1);
        for (std::size_t f = 0; f < coarse.face.size(); ++f)
            label[at(coarse.face[f])] = pieces.chart[f];
        result.chart = refine_labels(mesh.points, std::move(surface), std::move(label));
        progress.begin_phase("straightening borders", 0.1);
        if (options.straighten_boundaries) {
            const int rings =
                2 + static_cast<int>(2.0 * std::sqrt(static_cast<double>(mesh.face_count()) /
                                                     static_cast<double>(wanted)));
            straighten_borders(mesh, proxies_of_charts(coarse.mesh, pieces),
                               options.max_fitting_error, rings, result.chart, progress);
        }
        result.chart = absorb_fragments(mesh, result.chart, fragment_share);
        result.seam.assign(mesh.twin.size(), 0);
        std::vector<Index> tips;
        for (const Index v : pieces.tips)
            tips.push_back(coarse.vertex[at(v)]);
        result.darts = cut_darts_to(mesh, result.chart, tips, result.seam);
    }
    const ChartMap charts = make_chart_map(mesh, result.chart, result.seam, false);
    result.chart = charts.chart;
    const std::vector<ConicProxy> proxies = fit_conics(mesh, result.chart, charts.count);
    result.fitting_error.resize(mesh.faces.size());
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        result.fitting_error[f] = proxies[at(result.chart[f])].fitting_error(mesh.face_normals[f]);
    return result;
}

} // namespace devseg
