#include "devseg/methods/papercraft/papercraft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/flat_cuts.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/growth/seeds.h"
#include "devseg/methods/growth/vertex_growth.h"
#include "devseg/methods/papercraft/nets.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::papercraft {

using namespace declare;

namespace {

struct Tuning {
    double largest_defect = 0.5; // radians: paper that takes up more at one point is visibly bent
    double noise_radius = 0.015; // of the diagonal: defects of scans cancel out over this distance
    double noise_factor = 3.0;   // times the median: larger defects are features
    int most_averages = 50;
    int most_halvings = 12;       // of the growth threshold
    Index share_of_surplus = 8;   // of the charts that are too many, one in so many goes
    double seed_variation = 0.25; // of the costs, with random seeds
    double flat = 1e-5;           // radians: what rounding leaves of defects on flat faces
    // Faces of a component that people fold as it is: more of them approximate something round.
    Index most_net_faces = 128;
};
constexpr Tuning tuning;

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
    const double usual = tuning.noise_factor * *middle;
    std::vector<double> small;
    for (const double d : defect)
        small.push_back(std::clamp(d, -usual, usual));
    const double edge_squared = 4.0 / std::sqrt(3.0) * mesh.total_area / mesh.face_count();
    const double rounds = std::pow(tuning.noise_radius * diagonal, 2) / edge_squared;
    std::vector<double> cost = spread(
        mesh, std::move(small), static_cast<int>(std::min<double>(tuning.most_averages, rounds)));
    for (std::size_t v = 0; v < cost.size(); ++v)
        cost[v] = std::abs(defect[v]) > tuning.largest_defect
                      ? infinite
                      : std::abs(cost[v]) + std::max(0.0, std::abs(defect[v]) - usual);
    return cost;
}

void vary(std::vector<double>& cost, int random_seed) {
    std::mt19937 random(static_cast<std::uint32_t>(random_seed));
    for (double& c : cost)
        c *= 1.0 + tuning.seed_variation * (static_cast<double>(random()) / 4294967296.0 - 0.5);
}

// Removes seeds of the smallest charts, but never the last one of a component.
std::vector<Index> cull(const Mesh& mesh, const std::vector<Index>& seeds,
                        const growth::VertexCharts& grown, Index number) {
    const mesh::FaceComponents components = mesh::face_components(mesh, [](Index) { return true; });
    std::vector<Index> component(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        component[mesh.origin(h)] = components.label[face_of(h)];
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
            charts.chart[face_of(h)] == charts.chart[face_of(mesh.twin[h])])
            length += mesh.edge_length(h);
    return length;
}

} // namespace

OptionRanges<PapercraftOptions> PapercraftOptions::ranges() {
    using O = PapercraftOptions;
    return with_rounds<O>({{&O::charts_number, {"charts_number", 1, 1e9}},
                           {&O::max_net_faces, {"max_net_faces", 0, 1e9}},
                           {&O::growth_threshold, {"growth_threshold", 0.0, 1000.0, true}},
                           {&O::slit_threshold, {"slit_threshold", 0.0, 1000.0}}});
}

namespace {

// Charts with slits, to be deformed.
PapercraftResult grow_charts(const Mesh& mesh, const PapercraftOptions& options,
                             Progress& progress) {
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
    for (int i = 0; i < tuning.most_halvings && static_cast<Index>(seeds.size()) < wanted; ++i)
        seeds = growth.find_seeds(threshold *= 0.5, seeding);
    result.initial_charts = static_cast<Index>(seeds.size());

    auto selecting = progress.part("selecting charts", 0.92);
    growth::VertexCharts grown = growth.grow(seeds, selecting);
    while (static_cast<Index>(seeds.size()) > wanted) {
        ++result.rounds;
        const Index surplus = static_cast<Index>(seeds.size()) - wanted;
        const bool last = result.rounds == options.max_iterations;
        seeds = cull(mesh, seeds, grown,
                     last ? surplus : std::max<Index>(1, surplus / tuning.share_of_surplus));
        grown = growth.grow(seeds, selecting);
    }

    auto closing = progress.part("closing slits", 0.03);
    atlas::ChartMap charts = atlas::keep_flat_faces_whole(mesh, growth::adopt_orphans(mesh, grown));
    result.closed_edges =
        atlas::close_slits(mesh, cost, options.slit_threshold * diagonal, charts.seam).closed_edges;
    result.charts = atlas::make_chart_map(mesh, charts.chart, charts.seam, false);
    result.closed_edges += atlas::close_slits_to_holes(
        mesh, cost, std::max(options.slit_threshold, tuning.flat) * diagonal, result.charts);
    result.charts = atlas::cut_charts_to_disks(mesh, result.charts, closing).charts;
    atlas::lead_around_flat_faces(mesh, cost, tuning.flat, result.charts, closing);
    result.slit_length = slit_length(mesh, result.charts);
    return result;
}

// 1 for each face (#F) of a component that becomes nets.
std::vector<std::uint8_t> faces_of_nets(const Mesh& mesh, Deform deform) {
    std::vector<std::uint8_t> is_net(mesh.faces.size(), deform == Deform::never ? 1 : 0);
    if (deform != Deform::automatic)
        return is_net;
    const mesh::FaceComponents components = mesh::face_components(mesh, [](Index) { return true; });
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    std::vector<Index> component(at(regions.count));
    for (const Face f : mesh.all_faces())
        component[at(regions.label[f])] = components.label[f];
    std::vector<Index> faces(at(components.count), 0);
    for (const Index c : component)
        ++faces[at(c)];
    for (const Face f : mesh.all_faces())
        is_net[f] = faces[at(components.label[f])] <= tuning.most_net_faces ? 1 : 0;
    return is_net;
}

// The charts of a part, which was cut open along seams of `all`, come behind those that there are.
void append_charts(const atlas::ChartSurface& part, const atlas::ChartMap& charts,
                   atlas::ChartMap& all) {
    for (std::size_t f = 0; f < part.face.size(); ++f)
        all.chart[at(part.face[f])] = all.count + charts.chart[f];
    for (std::size_t h = 0; h < charts.seam.size(); ++h)
        all.seam[at(part.mesh_half_edge(static_cast<Index>(h)))] |= charts.seam[h];
    all.count += charts.count;
}

// Nets of the components that are polyhedra, charts with slits of the others.
// Flat faces with holes come apart from what stands in them (`rims`, 3 #F).
PapercraftResult nets_and_charts(const Mesh& mesh, const std::vector<std::uint8_t>& is_net,
                                 const std::vector<std::uint8_t>& rims,
                                 const PapercraftOptions& options, Progress& progress) {
    std::array<std::vector<Index>, 2> faces;
    for (const Face f : mesh.all_faces())
        faces[is_net[f]].push_back(f);
    PapercraftResult result;
    atlas::ChartMap all{std::vector<Index>(mesh.faces.size()), rims, 0};
    const auto surface_of = [&](std::size_t kind) {
        return atlas::extract_surface(mesh, faces[kind], all.seam);
    };
    if (!faces[0].empty()) {
        const atlas::ChartSurface surface = surface_of(0);
        PapercraftOptions own = options;
        own.charts_number = std::min(options.charts_number, static_cast<int>(surface.face.size()));
        result = grow_charts(atlas::mesh_of(mesh, surface), own, progress);
        append_charts(surface, result.charts, all);
    }
    if (!faces[1].empty()) {
        const atlas::ChartSurface surface = surface_of(1);
        auto unfolding = progress.part("unfolding", progress.left());
        const atlas::ChartMap nets = unfold_into_nets(
            atlas::mesh_of(mesh, surface), {options.random_seed, options.max_net_faces}, unfolding);
        result.nets = nets.count;
        append_charts(surface, nets, all);
    }
    result.charts = atlas::make_chart_map(mesh, all.chart, all.seam, false);
    result.slit_length = slit_length(mesh, result.charts);
    return result;
}

} // namespace

PapercraftResult segment_papercraft(const Mesh& mesh, const PapercraftOptions& options,
                                    Progress& progress) {
    check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    const std::vector<std::uint8_t> is_net = faces_of_nets(mesh, options.deform);
    std::vector<std::uint8_t> rims = atlas::rims_of_flat_faces(mesh);
    for (const HalfEdge h : mesh.all_half_edges())
        rims[h] = is_net[face_of(h)] != 0 ? 0 : rims[h];
    const auto any = [](const std::vector<std::uint8_t>& marks) {
        return std::find(marks.begin(), marks.end(), 1) != marks.end();
    };
    PapercraftResult result = any(is_net) || any(rims)
                                  ? nets_and_charts(mesh, is_net, rims, options, progress)
                                  : grow_charts(mesh, options, progress);
    const std::vector<double> defect = mesh::angle_defects(mesh);
    const std::vector<Index> valence = valences(mesh);
    result.defect_share.assign(mesh.faces.size(), 0.0);
    for (const HalfEdge h : mesh.all_half_edges())
        result.defect_share[face_of(h)] +=
            std::abs(defect[mesh.origin(h)]) / valence[mesh.origin(h)];
    return result;
}

// The filter
namespace {

constexpr const char* help =
    "Cuts the surface into few charts that paper can take on with <i>creases</i> and <i>slits</i>. "
    "Charts grow by vertices: a vertex may come inside of a chart if the angles around it sum up "
    "to nearly 360 degrees, whatever creases run through it. Where a chart meets itself a slit "
    "stays open, and ends at vertices that are far from developable. The smallest charts are "
    "removed and the others grown again until the wanted number is left, and slits that matter "
    "little are closed. Polyhedra of few faces become nets instead, which fold exactly as they "
    "are; no flat face is cut.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut, slits included), the same cuts as selected face-edges, the "
    "face's share of the angle defects of its vertices (radians) as face quality and a colour for "
    "each chart. Every chart is a disk but for flat holes. Go on with 'Charts: Deform to Exact "
    "Developability'.<br>"
    "See:<br><i>Kuniko Takahashi, Tomohiro Tachi, Yasushi Yamaguchi</i><br>"
    "<b>\"Mesh Approximation for Generating Development with Creases and Slits\"</b><br>"
    "Journal for Geometry and Graphics 19(1), 2015, pages 119-129";

FilterOutput run(const FilterInput& input, const PapercraftOptions& options, Progress& progress) {
    PapercraftResult result = segment_papercraft(input.mesh, options, progress);
    ResultValues values = {
        {"charts_number", result.charts.count},
        {"initial_charts_number", result.initial_charts},
        {"rounds_number", result.rounds},
        {"closed_edges_number", result.closed_edges},
        {"nets_number", result.nets},
        {"slit_length", result.slit_length * input.mesh.unit_length},
        {"seam_length", metrics::seam_length(input.mesh, result.charts)},
    };
    return chart_output(input.mesh, std::move(result.charts), std::move(result.defect_share),
                        std::move(values));
}

} // namespace

std::vector<FilterDeclaration> filters() {
    using O = PapercraftOptions;
    return {
        Declare<O>("Segmentation: Papercraft with Creases and Slits",
                   "compute_segmentation_papercraft_per_face", FilterCategory::remeshing, help)
            .integer(&O::charts_number, "Number of charts",
                     "From 1 to the number of faces. Fewer charts have more and longer slits. A "
                     "mesh of more components gets one chart for each of them.")
            .choice(
                &O::deform, "deform", "Deform", {"Automatic", "Always", "Never"},
                "Whether charts are made to be deformed until they unfold exactly (Always). Or "
                "they are nets that unfold exactly as they are (Never), as many as it takes. "
                "Automatic: nets of components that have few faces, those of one plane being one; "
                "charts of the others.")
            .integer(&O::max_net_faces, "Most faces of a net",
                     "Of charts that unfold as they are; those of one plane are one. 0 = no limit.")
            .real(&O::growth_threshold, "Growth threshold",
                  "What the inner vertices of a chart of the initial segmentation may lack to 360 "
                  "degrees, or have too much. All together, in radians, above 0. Smaller values "
                  "start from more and smaller charts; halved where there are fewer than wanted.")
            .real(&O::slit_threshold, "Slit threshold",
                  "Slits are closed where the paper has to bridge a gap of about this width, "
                  "as a share of the diagonal of the model's box. 0 closes none.")
            .integer(&O::max_iterations, "Most rounds",
                     "Rounds in which the smallest charts are removed and the others grown "
                     "again; the last one removes all that are too many.")
            .integer(&O::random_seed, "Random seed",
                     "0 takes angles as they are; other numbers vary them a little, for other "
                     "charts. The same number always gives the same charts.")
            .command("papercraft", "symmetric-dirichlet", "papercraft", true)
            .on_part()
            .keeps()
            .writes(writes_charts | writes_quality | writes_color)
            .result("charts_number", "charts, each a disk but for flat holes")
            .result("initial_charts_number", "charts of the initial segmentation")
            .result("rounds_number", "rounds of removing charts and growing the others")
            .result("closed_edges_number", "edges of slits that were closed")
            .result("nets_number", "charts that unfold exactly as they are")
            .result("slit_length", "length of the slits that are left, model units")
            .result("seam_length", "length of all cut edges, model units")
            .runs(run)};
}

} // namespace devseg::papercraft
