#include "devseg/methods/t_flooding/t_flooding.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "devseg/methods/growth/multi_heap.h"
#include "devseg/methods/growth/reseed.h"
#include "devseg/methods/growth/seeds.h"
#include "devseg/methods/t_flooding/balanced_borders.h"
#include "devseg/metrics/gauss_area.h"

namespace devseg::t_flooding {

namespace {

// [YGZS05, section 3.4] stops when the balance has not improved for this many rounds.
constexpr int patience = 10;

// Charts whose Gauss areas deviate by less than this share of the average need no further rounds.
constexpr double balanced = 0.08;
// Above this share another start is tried, which lets the seeds settle before there are offsets.
constexpr double unbalanced = 0.15;
// Seeds that rest: the damping factor shrinks by this whenever the balance gets worse.
constexpr double calming = 0.8;

// Local times of candidates behind a crease are scaled by this much: they sort behind all others
// of their heap, which no real time reaches.
constexpr float behind_crease = 1e20F;

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
                 const TFloodingOptions& options)
        : mesh_(mesh), areas_(areas), power_(options.speed_power), epsilon_(options.speed_epsilon),
          valence_(mesh.points.size(), 0), has_corner_(mesh.faces.size(), 0),
          time_(mesh.faces.size(), 0.0F) {
        for (const Triangle& t : mesh.faces)
            for (const Vertex v : t)
                ++valence_[v];
        for (const HalfEdge h : mesh.all_half_edges())
            if (areas.edge[h] > 0.0 || areas.vertex[mesh.origin(h)] > 0.0)
                has_corner_[h / 3] = 1;
        find_largest_curvature();
        wall_ = metrics::long_creases(mesh, areas.crease, options.charts_number);
        step_.resize(mesh.twin.size(), 0.0F);
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] >= 0)
                step_[h] = delay(h, areas.face[mesh.twin[h] / 3] + areas.edge[h]);
    }

    void start_over(std::vector<double> offsets) {
        offset_ = std::move(offsets);
        area_.assign(offset_.size(), 0.0);
        corner_owner_.assign(mesh_.points.size(), -1);
        corner_count_.assign(mesh_.points.size(), 0);
        chart_.assign(mesh_.faces.size(), -1);
    }

    // Δt of a step across h into the face behind it, with the corners that it would complete.
    growth::CandidateHeap::Entry candidate(HalfEdge h, Index c) const {
        const Face f = mesh_.twin[h] / 3;
        const float step = has_corner_[f] == 0
                               ? step_[h]
                               : delay(h, areas_.face[f] + areas_.edge[h] + corners(f, c));
        const float time = time_[h / 3] + step;
        return {wall_[h] != 0 ? (time + 1.0F) * behind_crease : time, time, f};
    }

    // The look-ahead of [YGZS05, section 3.3]: the area that the chart would have.
    FloodingKey key(Index c, const growth::CandidateHeap::Entry& entry) const {
        const int tier = entry.key >= behind_crease ? 1 : 0;
        return {tier, area_[c] + offset_[c] + gain(entry.face, c), entry.distance};
    }

    void take(Face f, Index c, float time) {
        area_[c] += gain(f, c);
        chart_[f] = c;
        time_[f] = time;
        if (has_corner_[f] == 0)
            return;
        for (const Vertex v : mesh_.faces[f]) {
            Index& owner = corner_owner_[v];
            owner = owner == -1 || owner == c ? c : shared;
            ++corner_count_[v];
        }
    }

    /// Δt of the step across a half-edge, without corners: the metric of reseeding.
    float step(HalfEdge h) const { return step_[h]; }
    const std::vector<double>& area() const { return area_; }

private:
    static constexpr Index shared = -2;

    // [YGZS05, section 3.3]: over all triangles, edges and vertices; edges and vertices take the
    // smallest of their triangles.
    void find_largest_curvature() {
        std::vector<double> least(mesh_.points.size(), infinite);
        const auto consider = [&](double gauss_area, double area) {
            if (area > 0.0 && std::isfinite(gauss_area / area))
                largest_curvature_ = std::max(largest_curvature_, gauss_area / area);
        };
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const double own = mesh_.face_areas[h / 3];
            const HalfEdge twin = mesh_.twin[h];
            least[mesh_.origin(h)] = std::min(least[mesh_.origin(h)], own);
            consider(areas_.face[h / 3], own);
            if (twin >= 0)
                consider(areas_.edge[h], std::min(own, mesh_.face_areas[twin / 3]));
        }
        for (std::size_t v = 0; v < least.size(); ++v)
            consider(areas_.vertex[v], least[v]);
    }

    // [YGZS05, equations 7 to 9] with curvatures as fractions of the largest.
    float delay(HalfEdge h, double gauss_area) const {
        const Face f = mesh_.twin[h] / 3;
        const double distance = (mesh_.face_centers[f] - mesh_.face_centers[h / 3]).norm();
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
            if (mesh_.twin[h] >= 0 && chart_[mesh_.twin[h] / 3] == c)
                sum += areas_.edge[h];
        return sum + corners(f, c);
    }

    const Mesh& mesh_;
    const metrics::GaussAreas& areas_;
    double power_;
    double epsilon_;
    double largest_curvature_ = 0.0;
    std::vector<Index> valence_;           // #V: faces around the vertex
    std::vector<std::uint8_t> has_corner_; // #F: an edge or vertex of the face has Gauss area
    std::vector<float> step_;              // 3 #F
    std::vector<std::uint8_t> wall_;       // 3 #F: creases that charts cross last
    std::vector<float> time_;              // #F: when the face was flooded, local time
    std::vector<Index> chart_;             // #F, of this round so far
    std::vector<Index> corner_owner_;      // #V: the only chart there so far, or shared
    std::vector<Index> corner_count_;      // #V: faces flooded so far
    std::vector<double> area_;             // Gauss area of each chart
    std::vector<double> offset_;           // A_off of each chart
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
    Rounds(const Mesh& mesh, const metrics::GaussAreas& areas, const TFloodingOptions& options,
           Progress& progress)
        : cost_(mesh, areas, options), heaps_(mesh), border_(mesh), options_(options),
          scale_(areas.total / options.charts_number), progress_(progress) {}

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
            if (since_best == patience) {
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
                damping *= calming;
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

    bool finished() const { return count_ == options_.max_iterations || is_balanced(balanced); }

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
    const std::vector<Index> seeds = growth::farthest_point_seeds(
        mesh, growth::at_least_one_per_component(mesh, options.charts_number),
        static_cast<std::uint32_t>(options.random_seed), placing);
    const Index count = static_cast<Index>(seeds.size());

    auto flooding = progress.part("flooding", 0.55);
    Rounds rounds(mesh, areas, options, flooding);
    rounds.run(seeds, true);
    if (!rounds.is_balanced(unbalanced))
        rounds.run(seeds, false);

    TFloodingResult result;
    result.chart = rounds.chart();
    result.rounds = rounds.count();
    result.converged = rounds.count() < options.max_iterations;
    if (options.straighten_boundaries) {
        auto straightening = progress.part("straightening borders", 1.0);
        balance_borders(mesh, areas, {}, count, result.chart, straightening);
    }
    result.chart_gauss_area = metrics::chart_gauss_areas(mesh, areas, result.chart, count);
    result.gauss_area_std = metrics::standard_deviation(result.chart_gauss_area);
    result.total_gauss_area = areas.total;
    result.face_gauss_area = std::move(areas.face);
    return result;
}

} // namespace devseg::t_flooding
