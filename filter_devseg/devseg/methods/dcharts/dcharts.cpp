// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#include "devseg/methods/dcharts/dcharts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/growth.h"
#include "devseg/methods/growth/seeds.h"

namespace devseg::dcharts {

namespace {

struct GrowingChart {
    Index seed = -1; // face
    metrics::ConicProxy proxy;
    double area = 0.0; // so far
};

// What a face costs a chart. Costs are compared as base-2 logarithms, so that the product of
// [JKS05, equation 2] is a sum, and the area of a chart, which all its entries share, is added once
// for the chart instead of once for each entry.
class ConeCost {
public:
    ConeCost(const Mesh& mesh, const DChartsOptions& options, const std::vector<Index>& chart)
        : max_fitting_error(options.max_fitting_error), mesh_(mesh), options_(options),
          chart_(chart), edge_length_(mesh.twin.size()), center_step_(mesh.twin.size()),
          distance_(mesh.faces.size()) {
        for (const HalfEdge h : mesh.all_half_edges()) {
            edge_length_[h] = static_cast<float>(mesh.edge_length(h));
            const HalfEdge twin = mesh.twin[h];
            if (twin >= 0)
                center_step_[h] = static_cast<float>(
                    (mesh.face_centers[face_of(h)] - mesh.face_centers[face_of(twin)]).norm());
        }
    }

    growth::CandidateHeap::Entry candidate(HalfEdge across, Index c) const {
        const Face f = face_of(mesh_.twin[across]);
        const double error = charts[c].proxy.fitting_error(mesh_.face_normals[f]);
        if (!(error < max_fitting_error))
            return {0.0F, 0.0F, -1};
        float inner = 0.0F;
        float outer = 0.0F;
        float distance = std::numeric_limits<float>::max();
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin >= 0 && chart_[face_of(twin)] == c) {
                inner += edge_length_[h];
                distance = std::min(distance, distance_[face_of(twin)] + center_step_[h]);
            } else {
                outer += edge_length_[h];
            }
        }
        const float key =
            static_cast<float>(options_.alpha) *
                std::log2(static_cast<float>(std::max(error, tuning.fitting_error_floor))) +
            weighted_log(2.0 * options_.beta, distance) +
            weighted_log(options_.gamma, outer / std::max(inner, 1e-30F));
        return {key, distance, f};
    }

    float key(Index c, const growth::CandidateHeap::Entry& entry) const {
        const double area = std::max(charts[c].area, std::numeric_limits<double>::min());
        return entry.key - static_cast<float>(options_.beta * std::log2(area));
    }

    void take(Face f, Index c, float distance) {
        distance_[f] = distance;
        charts[c].area += mesh_.face_areas[f];
    }

    std::vector<GrowingChart> charts;
    double max_fitting_error;

private:
    // A weight of 0 switches a term off. Degenerate faces have lengths of 0: the clamp keeps
    // every key finite, because infinity means that a chart has no candidate.
    static float weighted_log(double weight, float value) {
        return static_cast<float>(weight) * std::log2(std::clamp(value, 1e-30F, 1e30F));
    }

    const Mesh& mesh_;
    const DChartsOptions& options_;
    const std::vector<Index>& chart_; // #F
    std::vector<float> edge_length_;  // 3 #F
    std::vector<float> center_step_;  // 3 #F: distance of the centroids on both sides
    std::vector<float> distance_;     // #F: D(S_C, t) of [JKS05, section 2.1.2]
};

using Growth = growth::MultiHeap<growth::Offers::best>;

metrics::ConicProxy fit_faces(const Mesh& mesh, const std::vector<Index>& faces) {
    metrics::NormalMoments moments;
    for (const Face f : faces)
        moments.add(mesh.face_areas[f], mesh.face_normals[f]);
    return metrics::fit_conic(moments);
}

// The best of three proxies, from the faces around each vertex of the seed [JKS05, section 3.1].
GrowingChart first_chart(const Mesh& mesh, Face seed) {
    GrowingChart best{seed, {}};
    double best_error = infinite;
    for (const HalfEdge h : half_edges_of(seed)) {
        std::vector<Index> star;
        mesh::visit_star(mesh, h, [&](HalfEdge k) { star.push_back(face_of(k)); });
        const metrics::ConicProxy proxy = fit_faces(mesh, star);
        const double error = proxy.fitting_error(mesh.face_normals[seed]);
        if (error < best_error) {
            best_error = error;
            best.proxy = proxy;
        }
    }
    return best;
}

// Of the faces that fit best, the one nearest to the chart's centre [JKS05, section 3.1]. Faces
// below the error floor count as equally good: on a plane or a cylinder all faces compete.
Index best_seed(const Mesh& mesh, const std::vector<Index>& faces,
                const metrics::ConicProxy& proxy) {
    Vec3 centre = Vec3::Zero();
    double area = 0.0;
    std::vector<double> errors;
    for (const Face f : faces) {
        centre += mesh.face_areas[f] * mesh.face_centers[f];
        area += mesh.face_areas[f];
        errors.push_back(proxy.fitting_error(mesh.face_normals[f]));
    }
    centre = area > 0.0 ? Vec3(centre / area) : mesh.face_centers[faces.front()];
    const auto last =
        errors.begin() + std::min(tuning.seed_candidates, static_cast<Index>(faces.size())) - 1;
    std::nth_element(errors.begin(), last, errors.end());
    const double limit = std::max(*last, tuning.fitting_error_floor);
    Index best = -1;
    double best_distance = infinite;
    for (const Face f : faces) {
        if (proxy.fitting_error(mesh.face_normals[f]) > limit)
            continue;
        const double distance = (mesh.face_centers[f] - centre).squaredNorm();
        if (distance < best_distance) {
            best_distance = distance;
            best = f;
        }
    }
    return best;
}

std::vector<GrowingChart> reseed(const Mesh& mesh, const std::vector<Index>& chart, Index count) {
    const std::vector<metrics::ConicProxy> proxies = metrics::fit_conics(mesh, chart, count);
    std::vector<std::vector<Index>> faces(at(count));
    for (const Face f : mesh.all_faces())
        if (chart[f] >= 0)
            faces[chart[f]].push_back(f);
    std::vector<GrowingChart> charts;
    for (Index c = 0; c < count; ++c)
        charts.push_back({best_seed(mesh, faces[c], proxies[c]), proxies[c]});
    return charts;
}

// Lloyd iterations [JKS05, section 3.1]. Leaves −1 where no chart fits.
void lloyd(const Mesh& mesh, const DChartsOptions& options, Growth& growth, ConeCost& cost,
           DChartsResult& result, Progress& progress) {
    std::vector<Index> before;
    while (true) {
        std::vector<Index> seeds;
        for (const GrowingChart& chart : cost.charts)
            seeds.push_back(chart.seed);
        growth.grow(seeds, cost, result.chart, progress);
        ++result.rounds;
        progress.update(static_cast<double>(result.rounds) / options.max_iterations);
        const Index changed =
            before.empty() ? mesh.face_count()
                           : std::inner_product(before.begin(), before.end(), result.chart.begin(),
                                                Index{0}, std::plus<>(), std::not_equal_to<>());
        result.converged = changed < tuning.converged_share * mesh.face_count();
        if (result.converged || result.rounds == options.max_iterations)
            return;
        cost.charts = reseed(mesh, result.chart, static_cast<Index>(seeds.size()));
        before = result.chart;
    }
}

struct Hole {
    std::vector<Index> faces;
    double area = 0.0;
    bool touches_chart = false;
};

std::vector<Hole> find_holes(const Mesh& mesh, const std::vector<Index>& chart) {
    const auto is_open = [&](Face f) { return chart[f] < 0; };
    const mesh::FaceComponents parts = mesh::face_components(
        mesh, [&](HalfEdge h) { return is_open(face_of(h)) && is_open(face_of(mesh.twin[h])); });
    std::vector<Index> hole_of(at(parts.count), -1);
    std::vector<Hole> holes;
    for (const Face f : mesh.all_faces()) {
        if (!is_open(f))
            continue;
        Index& number = hole_of[parts.label[f]];
        if (number < 0) {
            number = static_cast<Index>(holes.size());
            holes.emplace_back();
        }
        Hole& hole = holes[number];
        hole.faces.push_back(f);
        hole.area += mesh.face_areas[f];
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            hole.touches_chart |= twin >= 0 && !is_open(face_of(twin));
        }
    }
    return holes;
}

// A chart of its own for a large hole: proxy and seed from all its faces, regrown within it.
void add_hole_chart(const Mesh& mesh, const Hole& hole, Growth& growth, ConeCost& cost,
                    DChartsResult& result, Progress& progress) {
    const metrics::ConicProxy proxy = fit_faces(mesh, hole.faces);
    const Face seed = best_seed(mesh, hole.faces, proxy);
    const Index c = static_cast<Index>(cost.charts.size());
    cost.charts.push_back({seed, proxy});
    result.chart[seed] = c;
    cost.take(seed, c, 0.0F);
    ++result.hole_charts;
    growth.spread({seed}, c + 1, cost, result.chart, progress);
}

// [JKS05, section 3.2]: large holes get charts, which may leave holes again; then the small ones
// are filled by the charts around them, whatever the fitting error.
void fill_holes(const Mesh& mesh, const DChartsOptions& options, Growth& growth, ConeCost& cost,
                DChartsResult& result, Progress& progress) {
    const double small_area =
        tuning.small_hole_share * mesh.total_area / static_cast<double>(options.charts_number);
    for (bool added = true; added;) {
        added = false;
        for (const Hole& hole : find_holes(mesh, result.chart))
            if (hole.area >= small_area || !hole.touches_chart) {
                add_hole_chart(mesh, hole, growth, cost, result, progress);
                added = true;
            }
        progress.update(0.5);
    }
    std::vector<Index> front;
    for (const Face f : mesh.all_faces()) {
        if (result.chart[f] < 0)
            continue;
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            if (twin >= 0 && result.chart[face_of(twin)] < 0) {
                front.push_back(f);
                break;
            }
        }
    }
    cost.max_fitting_error = infinite;
    growth.spread(front, static_cast<Index>(cost.charts.size()), cost, result.chart, progress);
}

} // namespace

std::vector<double> fitting_errors(const Mesh& mesh, const std::vector<Index>& chart,
                                   const std::vector<metrics::ConicProxy>& proxies) {
    std::vector<double> errors;
    for (const Face f : mesh.all_faces())
        errors.push_back(proxies[chart[f]].fitting_error(mesh.face_normals[f]));
    return errors;
}

OptionRanges<DChartsOptions> DChartsOptions::ranges() {
    using O = DChartsOptions;
    return with_rounds<O>({{&O::max_fitting_error, {"max_fitting_error", 0.0, 4.0, true}},
                           {&O::alpha, {"alpha", 0.0, 10.0}},
                           {&O::beta, {"beta", 0.0, 10.0}},
                           {&O::gamma, {"gamma", 0.0, 10.0}}});
}

DChartsResult segment_dcharts(const Mesh& mesh, const DChartsOptions& options, Progress& progress) {
    check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    DChartsResult result;

    auto placing = progress.part("placing seeds", 0.1);
    ConeCost cost(mesh, options, result.chart);
    for (const Face seed : growth::farthest_point_seeds(
             mesh, options.charts_number, static_cast<std::uint32_t>(options.random_seed), placing))
        cost.charts.push_back(first_chart(mesh, seed));

    auto growing = progress.part("growing charts", 0.7);
    Growth growth(mesh);
    lloyd(mesh, options, growth, cost, result, growing);

    auto filling = progress.part("filling holes", 0.2);
    fill_holes(mesh, options, growth, cost, result, filling);

    result.proxies =
        metrics::fit_conics(mesh, result.chart, static_cast<Index>(cost.charts.size()));
    result.fitting_error = fitting_errors(mesh, result.chart, result.proxies);
    return result;
}

} // namespace devseg::dcharts
