#include "devseg/methods/papercraft/papercraft.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "devseg/atlas/slit_closing.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/methods/growth/seeds.h"
#include "devseg/methods/growth/vertex_growth.h"

namespace devseg::papercraft {

namespace {

// Radians. Paper that takes up more at one point is visibly bent out of shape there.
constexpr double most_inner_defect = 0.5;
// Defects of scans cancel out over this distance, as a share of the diagonal.
constexpr double noise_radius = 0.015;
constexpr double noise_factor = 3.0; // times the median: larger defects are features
constexpr int most_averages = 50;
constexpr int most_halvings = 12;       // of the growth threshold
constexpr Index share_of_surplus = 8;   // of the charts that are too many, one in so many goes
constexpr double seed_variation = 0.25; // of the costs, with random seeds

double diagonal_of(const Mesh& mesh) {
    Vec3 low = mesh.points.front();
    Vec3 high = low;
    for (const Vec3& p : mesh.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

std::vector<Index> valences(const Mesh& mesh) {
    std::vector<Index> valence(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        ++valence[mesh.origin(h)];
    return valence;
}

// Every vertex keeps half of its value and gives the rest to its neighbours, `rounds` times: sums
// stay, and values of opposite sign cancel out. Nothing leaves across the mesh's boundary.
std::vector<double> spread(const Mesh& mesh, std::vector<double> value, int rounds) {
    const std::vector<std::uint8_t> boundary = mesh::boundary_vertices(mesh);
    const std::vector<Index> valence = valences(mesh);
    for (int round = 0; round < rounds; ++round) {
        std::vector<double> next(value.size(), 0.0);
        for (std::size_t v = 0; v < value.size(); ++v)
            next[v] = 0.5 * value[v];
        for (const HalfEdge h : mesh.all_half_edges()) {
            const Vertex from = mesh.origin(h);
            const Index to = boundary[mesh.target(h)] != 0 ? from : mesh.target(h);
            next[to] += 0.5 * value[from] / valence[from];
        }
        value = std::move(next);
    }
    return value;
}

// |2π − Σ θ| [TTY15, equation 2], without the noise of scans: what is usual on this mesh is
// averaged, and only the rest of larger defects counts in full.
std::vector<double> vertex_costs(const Mesh& mesh, const std::vector<double>& defect,
                                 double diagonal) {
    std::vector<double> sizes;
    for (const double d : defect)
        sizes.push_back(std::abs(d));
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const double usual = noise_factor * *middle;
    std::vector<double> small;
    for (const double d : defect)
        small.push_back(std::clamp(d, -usual, usual));
    const double edge_squared = 4.0 / std::sqrt(3.0) * mesh.total_area / mesh.face_count();
    const double rounds = std::pow(noise_radius * diagonal, 2) / edge_squared;
    std::vector<double> cost =
        spread(mesh, std::move(small), static_cast<int>(std::min<double>(most_averages, rounds)));
    for (std::size_t v = 0; v < cost.size(); ++v)
        cost[v] = std::abs(defect[v]) > most_inner_defect
                      ? infinite
                      : std::abs(cost[v]) + std::max(0.0, std::abs(defect[v]) - usual);
    return cost;
}

void vary(std::vector<double>& cost, int random_seed) {
    std::mt19937 random(static_cast<std::uint32_t>(random_seed));
    for (double& c : cost)
        c *= 1.0 + seed_variation * (static_cast<double>(random()) / 4294967296.0 - 0.5);
}

// Removes seeds of the smallest charts, but never the last one of a component.
std::vector<Index> cull(const Mesh& mesh, const std::vector<Index>& seeds,
                        const growth::VertexCharts& grown, Index number) {
    const mesh::FaceComponents components = mesh::face_components(mesh, [](Index) { return true; });
    std::vector<Index> component(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        component[mesh.origin(h)] = components.label[h / 3];
    std::vector<Index> left(at(components.count), 0);
    for (const Index seed : seeds)
        ++left[component[seed]];
    std::vector<std::size_t> order(seeds.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return grown.face_count[a] < grown.face_count[b];
    });
    std::vector<std::uint8_t> gone(seeds.size(), 0);
    for (const std::size_t c : order) {
        Index& rest = left[component[seeds[c]]];
        if (number == 0 || rest == 1)
            continue;
        --rest;
        --number;
        gone[c] = 1;
    }
    std::vector<Index> kept;
    for (std::size_t c = 0; c < seeds.size(); ++c)
        if (gone[c] == 0)
            kept.push_back(seeds[c]);
    return kept;
}

double slit_length(const Mesh& mesh, const atlas::ChartMap& charts) {
    double length = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h && charts.seam[h] != 0 &&
            charts.chart[h / 3] == charts.chart[mesh.twin[h] / 3])
            length += mesh.edge_length(h);
    return length;
}

} // namespace

OptionRanges<PapercraftOptions> PapercraftOptions::ranges() {
    using O = PapercraftOptions;
    return with_rounds<O>({{&O::charts_number, {"charts_number", 1, 1e9}},
                           {&O::growth_threshold, {"growth_threshold", 0.0, 1000.0, true}},
                           {&O::slit_threshold, {"slit_threshold", 0.0, 1000.0}}});
}

PapercraftResult segment_papercraft(const Mesh& mesh, const PapercraftOptions& options,
                                    Progress& progress) {
    check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    const double diagonal = diagonal_of(mesh);
    const std::vector<double> defect = mesh::angle_defects(mesh);
    std::vector<double> cost = vertex_costs(mesh, defect, diagonal);
    if (options.random_seed > 0)
        vary(cost, options.random_seed);
    const Index wanted = growth::at_least_one_per_component(mesh, options.charts_number);
    growth::VertexGrowth growth(mesh, cost);
    PapercraftResult result;

    auto seeding = progress.part("placing seeds", 0.05);
    double threshold = options.growth_threshold;
    std::vector<Index> seeds = growth.find_seeds(threshold, seeding);
    for (int i = 0; i < most_halvings && static_cast<Index>(seeds.size()) < wanted; ++i)
        seeds = growth.find_seeds(threshold *= 0.5, seeding);
    result.initial_charts = static_cast<Index>(seeds.size());

    auto selecting = progress.part("selecting charts", 0.92);
    growth::VertexCharts grown = growth.grow(seeds, selecting);
    while (static_cast<Index>(seeds.size()) > wanted) {
        ++result.rounds;
        const Index surplus = static_cast<Index>(seeds.size()) - wanted;
        const bool last = result.rounds == options.max_iterations;
        seeds = cull(mesh, seeds, grown,
                     last ? surplus : std::max<Index>(1, surplus / share_of_surplus));
        grown = growth.grow(seeds, selecting);
    }

    const auto closing = progress.part("closing slits", 0.03);
    atlas::ChartMap charts = growth::adopt_orphans(mesh, grown);
    result.closed_edges =
        atlas::close_slits(mesh, cost, options.slit_threshold * diagonal, charts.seam).closed_edges;
    result.charts = atlas::make_chart_map(mesh, charts.chart, charts.seam, false);
    result.slit_length = slit_length(mesh, result.charts);
    const std::vector<Index> valence = valences(mesh);
    result.defect_share.assign(mesh.faces.size(), 0.0);
    for (const HalfEdge h : mesh.all_half_edges())
        result.defect_share[h / 3] += std::abs(defect[mesh.origin(h)]) / valence[mesh.origin(h)];
    return result;
}

} // namespace devseg::papercraft
