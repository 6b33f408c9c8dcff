#include "devseg/methods/t_flooding/t_flooding.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/methods/growth/growth.h"
#include "devseg/methods/growth/seeds.h"
#include "devseg/methods/t_flooding/balanced_borders.h"
#include "devseg/metrics/gauss_area.h"

namespace devseg::t_flooding {

using namespace declare;

namespace {

struct FloodingTuning {
    // [YGZS05, section 3.4] stops when the balance has not improved for this many rounds.
    int rounds_without_gain = 10;
    // Charts whose Gauss areas deviate by less than this share of the average need no further
    // rounds.
    double balanced = 0.08;
    // Above this share another start is tried, which lets the seeds settle before there are
    // offsets.
    double unbalanced = 0.15;
    // Seeds that rest: the damping factor shrinks by this whenever the balance gets worse.
    double calming = 0.8;
    // Local times of candidates behind a crease are scaled by this much: they sort behind all
    // others of their heap, which no real time reaches.
    float behind_crease = 1e20F;
};
constexpr FloodingTuning tuning;

// Rank of a chart's best candidate, compared from first to last.
struct FloodingKey {
    int tier = 2; // 1 = behind a crease: waits for all others; 2 = none
    double area = 0.0;
    float time = 0.0F;

    bool operator<(const FloodingKey& other) const {
        return std::tie(tier, area, time) < std::tie(other.tier, other.area, other.time);
    }
};

// What a face adds to a chart, and how fast charts flow over it.
class FloodingCost {
public:
    FloodingCost(const Mesh& mesh, const metrics::GaussAreas& areas,
                 const TFloodingOptions& options, const std::vector<Index>& chart)
        : mesh_(mesh), areas_(areas), chart_(chart), power_(options.speed_power),
          epsilon_(options.speed_epsilon), valence_(mesh.points.size(), 0),
          has_corner_(mesh.faces.size(), 0), time_(mesh.faces.size(), 0.0F) {
        for (const Triangle& t : mesh.faces)
            for (const Vertex v : t)
                ++valence_[v];
        for (const HalfEdge h : mesh.all_half_edges())
            if (areas.edge[h] > 0.0 || areas.vertex[mesh.origin(h)] > 0.0)
                has_corner_[face_of(h)] = 1;
        find_largest_curvature();
        wall_ = metrics::long_creases(mesh, areas.crease, options.charts_number);
        step_.resize(mesh.twin.size(), 0.0F);
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] >= 0)
                step_[h] = delay(h, areas.face[face_of(mesh.twin[h])] + areas.edge[h]);
    }

    void start_over(std::vector<double> offsets) {
        offset_ = std::move(offsets);
        area_.assign(offset_.size(), 0.0);
        corner_owner_.assign(mesh_.points.size(), -1);
        corner_count_.assign(mesh_.points.size(), 0);
    }

    // Δt of a step across h into the face behind it, with the corners that it would complete.
    growth::CandidateHeap::Entry candidate(HalfEdge h, Index c) const {
        const Face f = face_of(mesh_.twin[h]);
        const float step = has_corner_[f] == 0
                               ? step_[h]
                               : delay(h, areas_.face[f] + areas_.edge[h] + corners(f, c));
        const float time = time_[face_of(h)] + step;
        return {wall_[h] != 0 ? (time + 1.0F) * tuning.behind_crease : time, time, f};
    }

    // The look-ahead of [YGZS05, section 3.3]: the area that the chart would have.
    FloodingKey key(Index c, const growth::CandidateHeap::Entry& entry) const {
        const int tier = entry.key >= tuning.behind_crease ? 1 : 0;
        return {tier, area_[c] + offset_[c] + gain(entry.face, c), entry.distance};
    }

    void take(Face f, Index c, float time) {
        area_[c] += gain(f, c);
        time_[f] = time;
        if (has_corner_[f] == 0)
            return;
        for (const Vertex v : mesh_.faces[f]) {
            Index& owner = corner_owner_[v];
            owner = owner == -1 || owner == c ? c : -2;
            ++corner_count_[v];
        }
    }

    /// Δt of the step across a half-edge, without corners: the metric of reseeding.
    float step(HalfEdge h) const { return step_[h]; }
    const std::vector<double>& area() const { return area_; }

private:
    // [YGZS05, section 3.3]: over all triangles, edges and vertices; edges and vertices take the
    // smallest of their triangles.
    void find_largest_curvature() {
        std::vector<double> least(mesh_.points.size(), infinite);
        const auto consider = [&](double gauss_area, double area) {
            if (area > 0.0 && std::isfinite(gauss_area / area))
                largest_curvature_ = std::max(largest_curvature_, gauss_area / area);
        };
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const double own = mesh_.face_areas[face_of(h)];
            const HalfEdge twin = mesh_.twin[h];
            least[mesh_.origin(h)] = std::min(least[mesh_.origin(h)], own);
            consider(areas_.face[face_of(h)], own);
            if (twin >= 0)
                consider(areas_.edge[h], std::min(own, mesh_.face_areas[face_of(twin)]));
        }
        for (std::size_t v = 0; v < least.size(); ++v)
            consider(areas_.vertex[v], least[v]);
    }

    // [YGZS05, equations 7 to 9] with curvatures as fractions of the largest.
    float delay(HalfEdge h, double gauss_area) const {
        const Face f = face_of(mesh_.twin[h]);
        const double distance = (mesh_.face_centers[f] - mesh_.face_centers[face_of(h)]).norm();
        const double bound = mesh_.face_areas[f] * largest_curvature_;
        const double curvature = gauss_area < bound ? gauss_area / bound : gauss_area > 0.0;
        return static_cast<float>(distance * std::pow(curvature + epsilon_, power_));
    }

    // Area of the corners that face f would complete in chart c.
    double corners(Face f, Index c) const {
        double sum = 0.0;
        for (const Vertex v : mesh_.faces[f])
            if (areas_.vertex[v] > 0.0 && valence_[v] == corner_count_[v] + 1 &&
                corner_owner_[v] == c)
                sum += areas_.vertex[v];
        return sum;
    }

    double gain(Face f, Index c) const {
        double sum = areas_.face[f];
        if (has_corner_[f] == 0)
            return sum;
        for (const HalfEdge h : half_edges_of(f))
            if (mesh_.twin[h] >= 0 && chart_[face_of(mesh_.twin[h])] == c)
                sum += areas_.edge[h];
        return sum + corners(f, c);
    }

    const Mesh& mesh_;
    const metrics::GaussAreas& areas_;
    const std::vector<Index>& chart_; // #F, of this round so far
    double power_;
    double epsilon_;
    double largest_curvature_ = 0.0;
    std::vector<Index> valence_;           // #V: faces around the vertex
    std::vector<std::uint8_t> has_corner_; // #F: an edge or vertex of the face has Gauss area
    std::vector<float> step_;              // 3 #F
    std::vector<std::uint8_t> wall_;       // 3 #F: creases that charts cross last
    std::vector<float> time_;              // #F: when the face was flooded, local time
    std::vector<Index> corner_owner_; // #V: the only chart there so far, −1: none, −2: several
    std::vector<Index> corner_count_; // #V: faces flooded so far
    std::vector<double> area_;        // Gauss area of each chart
    std::vector<double> offset_;      // A_off of each chart
};

// [YGZS05, section 3.5], read as: the larger a chart came out, the later it starts next time.
void raise_offsets(const std::vector<double>& area, double damping, std::vector<double>& offsets) {
    const double smallest = *std::min_element(area.begin(), area.end());
    for (std::size_t c = 0; c < area.size(); ++c)
        offsets[c] += damping * (area[c] - smallest);
}

// The rounds of flooding, reseeding and offsets; keeps the best.
class Rounds {
public:
    Rounds(const Mesh& mesh, const metrics::GaussAreas& areas, const mesh::Facets& facets,
           const TFloodingOptions& options, Progress& progress)
        : cost_(mesh, areas, options, chart_), heaps_(mesh, facets), border_(mesh),
          options_(options), scale_(areas.total / options.charts_number), progress_(progress) {}

    /// One start: seeds move until they come back or stop helping, then only the offsets change.
    /// Without `early_offsets` there are none until then.
    void run(std::vector<Index> seeds, bool early_offsets) {
        Round best;
        std::vector<double> offsets(seeds.size(), 0.0);
        std::set<std::vector<Index>> seen{seeds};
        double damping = options_.offset_damping;
        double before = infinite;
        bool seeds_rest = false;
        for (int since_best = 0; !finished();) {
            const Round round = flood(seeds, offsets);
            since_best = round.deviation < best.deviation ? 0 : since_best + 1;
            if (since_best == 0)
                best = round;
            if (since_best == tuning.rounds_without_gain) {
                if (seeds_rest)
                    return;
                seeds_rest = true;
                since_best = 0;
                seeds = best.seeds;
                offsets = best.offsets;
                raise_offsets(best.area, damping, offsets);
                continue;
            }
            if (seeds_rest && round.deviation > before)
                damping *= tuning.calming;
            before = round.deviation;
            if (early_offsets || seeds_rest)
                raise_offsets(round.area, damping, offsets);
            if (seeds_rest)
                continue;
            seeds = border_
                        .farthest_faces(
                            chart_, seeds, [&](HalfEdge h) { return cost_.step(h); }, progress_)
                        .face;
            seeds_rest = !seen.insert(seeds).second;
        }
    }

    bool is_balanced(double share) const { return deviation_ <= share * scale_; }
    const std::vector<Index>& chart() const { return best_chart_; }
    int count() const { return count_; }

private:
    struct Round {
        std::vector<Index> seeds;
        std::vector<double> offsets;
        std::vector<double> area;
        double deviation = infinite;
    };

    bool finished() const {
        return count_ == options_.max_iterations || is_balanced(tuning.balanced);
    }

    Round flood(const std::vector<Index>& seeds, const std::vector<double>& offsets) {
        cost_.start_over(offsets);
        heaps_.grow(seeds, cost_, chart_, progress_);
        progress_.update(static_cast<double>(++count_) / options_.max_iterations);
        Round round{seeds, offsets, cost_.area(), metrics::standard_deviation(cost_.area())};
        if (round.deviation < deviation_) {
            deviation_ = round.deviation;
            best_chart_ = chart_;
        }
        return round;
    }

    FloodingCost cost_;
    growth::MultiHeap<growth::Offers::first> heaps_;
    growth::BorderDistance border_;
    const TFloodingOptions& options_;
    double scale_; // Gauss area of an average chart
    Progress& progress_;
    std::vector<Index> chart_;      // of the last round
    std::vector<Index> best_chart_; // of the best round of all starts
    double deviation_ = infinite;
    int count_ = 0;
};

} // namespace

OptionRanges<TFloodingOptions> TFloodingOptions::ranges() {
    using O = TFloodingOptions;
    return with_rounds<O>({{&O::charts_number, {"charts_number", 1, 1e9}},
                           {&O::crease_angle, {"crease_angle", 0.0, 180.0, true}},
                           {&O::speed_power, {"speed_power", 0.0, 6.0}},
                           {&O::speed_epsilon, {"speed_epsilon", 0.0, 1.0, true}},
                           {&O::offset_damping, {"offset_damping", 0.0, 1.0, true}}});
}

TFloodingResult segment_t_flooding(const Mesh& mesh, const TFloodingOptions& options,
                                   Progress& progress) {
    check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    const auto measuring = progress.part("measuring Gauss areas", 0.02);
    metrics::GaussAreas areas = metrics::compute_gauss_areas(mesh, options.crease_angle * degrees);

    auto placing = progress.part("placing seeds", 0.03);
    const Index count = growth::at_least_one_per_component(mesh, options.charts_number);
    const mesh::Facets facets(mesh, count);
    const std::vector<Index> seeds = growth::farthest_point_seeds(
        mesh, count, static_cast<std::uint32_t>(options.random_seed), placing, facets);

    auto flooding = progress.part("flooding", 0.55);
    Rounds rounds(mesh, areas, facets, options, flooding);
    rounds.run(seeds, true);
    if (!rounds.is_balanced(tuning.unbalanced))
        rounds.run(seeds, false);

    TFloodingResult result;
    result.chart = rounds.chart();
    result.rounds = rounds.count();
    result.converged = rounds.count() < options.max_iterations;
    if (options.straighten_boundaries) {
        auto straightening = progress.part("straightening borders", 1.0);
        balance_borders(mesh, areas, facets, {}, count, result.chart, straightening);
    }
    result.chart_gauss_area = metrics::chart_gauss_areas(mesh, areas, result.chart, count);
    result.gauss_area_std = metrics::standard_deviation(result.chart_gauss_area);
    result.total_gauss_area = areas.total;
    result.face_gauss_area = std::move(areas.face);
    return result;
}

// The filter
namespace {

constexpr const char* help =
    "Cuts the surface into a given number of charts that are equally far from developable: all "
    "sweep about the same area on the sphere of normals (the <i>Gauss area</i>, which stands for "
    "Gaussian curvature). Charts flood the surface from seeds, slowly where it is curved; the one "
    "with the least Gauss area is always next. Seeds move to the middle of their charts, and "
    "offsets delay charts that became too large in the round before. Creases and corners count "
    "only inside of charts, so that borders follow them.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut), the same cuts as selected face-edges, the Gauss area as face "
    "quality and a colour for each chart. Every chart is cut to a disk but for flat holes.<br>"
    "See:<br><i>Hitoshi Yamauchi, Stefan Gumhold, Rhaleb Zayer, Hans-Peter Seidel</i><br>"
    "<b>\"Mesh Segmentation Driven by Gaussian Curvature\"</b><br>"
    "The Visual Computer 21, 2005, doi:10.1007/s00371-005-0319-x";

struct Options : TFloodingOptions {
    bool cut_tips = true;
};

FilterOutput run(const FilterInput& input, const Options& options, Progress& progress) {
    auto segmenting = progress.part(0.96);
    TFloodingResult result = segment_t_flooding(input.mesh, options, segmenting);
    FilterOutput output =
        segmentation_output(input, result.chart, std::move(result.face_gauss_area),
                            {options.cut_tips, {1.0}}, progress); // horns as wide as the chart too
    // Charts are numbered anew by their first face: the values follow.
    std::vector<double> gauss_area(result.chart_gauss_area.size());
    for (std::size_t f = 0; f < result.chart.size(); ++f)
        gauss_area[output.charts->chart[f]] = result.chart_gauss_area[result.chart[f]];
    output.values.insert(output.values.end(), {{"chart_gauss_area", std::move(gauss_area)},
                                               {"gauss_area_std", result.gauss_area_std},
                                               {"total_gauss_area", result.total_gauss_area},
                                               {"rounds_number", result.rounds},
                                               {"converged", result.converged}});
    return output;
}

} // namespace

std::vector<FilterDeclaration> filters() {
    using O = Options;
    return {
        Declare<O>("Segmentation: t-flooding", "compute_segmentation_t_flooding_per_face",
                   FilterCategory::remeshing, help)
            .integer(&O::charts_number, "Number of charts",
                     "From 1 to the number of faces. A mesh of more components gets one chart for "
                     "each of them.")
            .real(&O::crease_angle, "Crease angle",
                  "Edges that bend by more than this are creases, degrees, above 0. Smooth edges "
                  "and vertices have no Gauss area of their own.")
            .real(&O::speed_power, "Power of the speed",
                  "Exponent of the curvature in the time that a chart takes to flood a face, "
                  "without unit. Larger values follow features more closely; 0 ignores them.")
            .real(&O::speed_epsilon, "Least curvature",
                  "Added to the curvature, as a share of the largest one on the mesh, above 0. "
                  "Larger values follow features less.")
            .real(
                &O::offset_damping, "Damping of offsets",
                "Share of the imbalance between charts that the next round takes up, without unit, "
                "above 0.")
            .boolean(&O::straighten_boundaries, "straighten_boundaries", "Straighten borders",
                     "Make the borders between charts short while the charts stay balanced.")
            .boolean(&O::cut_tips, "cut_tips", "Cut tips",
                     "Cut charts open up to tips that are at least half as high as the loop around "
                     "them is long: horns, fingers and limbs.")
            .integer(&O::max_iterations, "Most rounds",
                     "The rounds of flooding and reseeding end here at the latest; usually the "
                     "balance stops improving earlier.")
            .integer(&O::random_seed, "Random seed",
                     "0 starts at the face farthest from the centre; other numbers at a random "
                     "face. The same number always gives the same charts.")
            .command("t-flooding")
            .on_part()
            .keeps()
            .writes(writes_charts | writes_quality | writes_color)
            .result("charts_number", "charts, each a disk but for flat holes")
            .result("cut_length", "length of the cuts inside of charts, model units")
            .result("seam_length", "length of all cut edges, model units")
            .result("chart_gauss_area", "Gauss area of each chart, steradians")
            .result("gauss_area_std", "standard deviation of the charts' Gauss areas, steradians")
            .result("total_gauss_area", "Gauss area of the whole mesh, steradians")
            .result("rounds_number", "rounds of flooding")
            .result("converged", "whether the rounds ended before max_iterations")
            .runs(run)};
}

} // namespace devseg::t_flooding
