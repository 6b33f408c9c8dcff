// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#include "devseg/methods/dcharts/dcharts.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "devseg/atlas/charts.h"
#include "devseg/base/errors.h"
#include "devseg/methods/growth/growth.h"
#include "devseg/methods/growth/seeds.h"

namespace devseg::dcharts {

namespace {

// [JKS05] stops when fewer faces than this change their chart between two rounds.
constexpr double converged_share = 0.05;

// [JKS05] looks at the k faces with the smallest fitting error for the next seed.
constexpr std::size_t seed_candidates = 10;

// On planes and cylinders F is 0 and the product cost would ignore compactness. The floor is the
// error of a normal that leans 1 degree against a cylinder's: less is within the noise of meshes.
constexpr double fitting_error_floor = 3e-4;

// A hole below this share of the average chart's area is filled by its neighbours; a larger one
// gets charts of its own [JKS05, section 3.2, which gives no number].
constexpr double small_hole_share = 0.25;

constexpr double unbounded = infinite;
constexpr Index update_every = 4096; // faces between two looks at the progress object

template <class T>
[[noreturn]] void refuse(const char* name, const std::string& range, T found) {
    std::ostringstream text;
    text << name << ": expected " << range << ", found " << found;
    throw InvalidParameter(text.str());
}

struct Seed {
    Face face = -1;
    metrics::ConicProxy proxy;
};

// Grows charts from seeds over unassigned faces. Costs are compared as base-2 logarithms, so that
// the product of [JKS05, equation 2] is a sum, and the area of a chart, which all its entries
// share, is added once for the chart instead of once for each entry.
class Growth {
public:
    Growth(const Mesh& mesh, const DChartsOptions& options) : mesh_(mesh), options_(options) {
        edge_length_.resize(mesh.twin.size());
        center_step_.resize(mesh.twin.size());
        for (const HalfEdge h : mesh.all_half_edges()) {
            edge_length_[h] = static_cast<float>(mesh.edge_length(h));
            const Index opposite = mesh.twin[h];
            if (opposite >= 0)
                center_step_[h] = static_cast<float>(
                    (mesh.face_centers[h / 3] - mesh.face_centers[opposite / 3]).norm());
        }
        distance_.resize(mesh.faces.size());
    }

    void start_over() { area_.clear(); }

    // Continues the charts in `chart` (−1 = unassigned) with the given proxies, from the assigned
    // faces in `front`. Faces that were assigned by hand since the last call are in `planted`.
    void run(const std::vector<Seed>& charts, double max_fitting_error,
             const std::vector<Index>& front, const std::vector<Index>& planted,
             std::vector<Index>& chart, Progress& progress) {
        heaps_.resize(charts.size());
        for (growth::CandidateHeap& heap : heaps_)
            heap.clear();
        area_.resize(charts.size(), 0.0);
        growth::Tournament tournament(static_cast<Index>(charts.size()));
        max_fitting_error_ = max_fitting_error;
        for (const Face f : planted)
            distance_[f] = 0.0F;
        for (const Face f : planted)
            area_[chart[f]] += mesh_.face_areas[f];
        for (const Face f : front)
            offer_neighbours(f, charts, chart);
        for (Index c = 0; c < static_cast<Index>(charts.size()); ++c)
            tournament.set(c, key_of(c, chart));

        Index added = 0;
        while (tournament.key(tournament.winner()) < std::numeric_limits<float>::infinity()) {
            const Index c = tournament.winner();
            const growth::CandidateHeap::Entry entry = heaps_[c].top();
            heaps_[c].pop();
            if (chart[entry.face] < 0) {
                chart[entry.face] = c;
                distance_[entry.face] = entry.distance;
                area_[c] += mesh_.face_areas[entry.face];
                offer_neighbours(entry.face, charts, chart);
                if (++added % update_every == 0)
                    progress.update(0.0);
            }
            tournament.set(c, key_of(c, chart));
        }
    }

private:
    // Key of the chart's best candidate; candidates that other charts took meanwhile are dropped.
    float key_of(Index c, const std::vector<Index>& chart) {
        growth::CandidateHeap& heap = heaps_[c];
        while (!heap.empty() && chart[heap.top().face] >= 0)
            heap.pop();
        if (heap.empty())
            return std::numeric_limits<float>::infinity();
        const double area = std::max(area_[c], std::numeric_limits<double>::min());
        return heap.top().key - static_cast<float>(options_.beta * std::log2(area));
    }

    void offer_neighbours(Face f, const std::vector<Seed>& charts,
                          const std::vector<Index>& chart) {
        const Index c = chart[f];
        for (const HalfEdge h : half_edges_of(f)) {
            const Index opposite = mesh_.twin[h];
            if (opposite >= 0 && chart[opposite / 3] < 0)
                offer(opposite / 3, c, charts[c].proxy, chart);
        }
    }

    void offer(Face f, Index c, const metrics::ConicProxy& proxy, const std::vector<Index>& chart) {
        const double error = proxy.fitting_error(mesh_.face_normals[f]);
        if (!(error < max_fitting_error_))
            return;
        float inner = 0.0F;
        float outer = 0.0F;
        float distance = std::numeric_limits<float>::max();
        for (const HalfEdge h : half_edges_of(f)) {
            const Index opposite = mesh_.twin[h];
            if (opposite >= 0 && chart[opposite / 3] == c) {
                inner += edge_length_[h];
                distance = std::min(distance, distance_[opposite / 3] + center_step_[h]);
            } else {
                outer += edge_length_[h];
            }
        }
        const float key = static_cast<float>(options_.alpha) *
                              std::log2(static_cast<float>(std::max(error, fitting_error_floor))) +
                          weighted_log(2.0 * options_.beta, distance) +
                          weighted_log(options_.gamma, outer / std::max(inner, 1e-30F));
        heaps_[c].push({key, distance, f});
    }

    // A weight of 0 switches a term off. Degenerate faces have lengths of 0: the clamp keeps
    // every key finite, because infinity means that a chart has no candidate.
    static float weighted_log(double weight, float value) {
        return static_cast<float>(weight) * std::log2(std::clamp(value, 1e-30F, 1e30F));
    }

    const Mesh& mesh_;
    const DChartsOptions& options_;
    double max_fitting_error_ = 0.0;
    std::vector<float> edge_length_; // 3 #F
    std::vector<float> center_step_; // 3 #F: distance of the centroids on both sides
    std::vector<float> distance_;    // #F: D(S_C, t) of [JKS05, section 2.1.2]
    std::vector<growth::CandidateHeap> heaps_;
    std::vector<double> area_;
};

// The faces around a corner's vertex.
metrics::NormalMoments vertex_star(const Mesh& mesh, Index corner) {
    metrics::NormalMoments moments;
    mesh::visit_star(mesh, corner, [&](HalfEdge h) {
        moments.add(mesh.face_areas[h / 3], mesh.face_normals[h / 3]);
    });
    return moments;
}

// The best of three proxies, from the faces around each vertex of the seed [JKS05, section 3.1].
Seed initial_seed(const Mesh& mesh, Face face) {
    Seed best;
    best.face = face;
    double best_error = unbounded;
    for (const HalfEdge h : half_edges_of(face)) {
        const metrics::ConicProxy proxy = metrics::fit_conic(vertex_star(mesh, h));
        const double error = proxy.fitting_error(mesh.face_normals[face]);
        if (error < best_error) {
            best_error = error;
            best.proxy = proxy;
        }
    }
    return best;
}

// Of the faces that fit best, the one nearest to the chart's centre [JKS05, section 3.1]. Faces
// below the error floor count as equally good: on a plane or a cylinder all faces compete.
Index next_seed(const Mesh& mesh, const std::vector<Index>& faces, const metrics::ConicProxy& proxy,
                std::vector<double>& errors) {
    Vec3 centre = Vec3::Zero();
    double area = 0.0;
    errors.clear();
    for (const Face f : faces) {
        centre += mesh.face_areas[f] * mesh.face_centers[f];
        area += mesh.face_areas[f];
        errors.push_back(proxy.fitting_error(mesh.face_normals[f]));
    }
    centre = area > 0.0 ? Vec3(centre / area) : mesh.face_centers[faces.front()];
    const std::size_t rank = std::min(seed_candidates, faces.size()) - 1;
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(rank),
                     errors.end());
    const double limit = std::max(errors[rank], fitting_error_floor);
    Index best = -1;
    double best_distance = unbounded;
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

void reseed(const Mesh& mesh, const std::vector<Index>& chart, std::vector<Seed>& seeds) {
    const Index count = static_cast<Index>(seeds.size());
    const std::vector<metrics::ConicProxy> proxies = metrics::fit_conics(mesh, chart, count);
    std::vector<std::vector<Index>> faces(at(count));
    for (const Face f : mesh.all_faces())
        if (chart[f] >= 0)
            faces[chart[f]].push_back(f);
    std::vector<double> errors;
    for (Index c = 0; c < count; ++c) {
        seeds[c].proxy = proxies[c];
        seeds[c].face = next_seed(mesh, faces[c], proxies[c], errors);
    }
}

std::vector<Index> plant(const std::vector<Seed>& seeds, std::vector<Index>& chart) {
    std::vector<Index> front;
    for (std::size_t c = 0; c < seeds.size(); ++c) {
        chart[seeds[c].face] = static_cast<Index>(c);
        front.push_back(seeds[c].face);
    }
    return front;
}

// Lloyd iterations [JKS05, section 3.1]. Leaves −1 where no chart fits.
void lloyd(const Mesh& mesh, const DChartsOptions& options, Growth& growth,
           std::vector<Seed>& seeds, DChartsResult& result, Progress& progress) {
    std::vector<Index> before;
    while (true) {
        result.chart.assign(mesh.faces.size(), -1);
        const std::vector<Index> front = plant(seeds, result.chart);
        growth.start_over();
        growth.run(seeds, options.max_fitting_error, front, front, result.chart, progress);
        ++result.rounds;
        progress.update(static_cast<double>(result.rounds) / options.max_iterations);
        Index changed = mesh.face_count();
        if (!before.empty()) {
            changed = 0;
            for (std::size_t f = 0; f < before.size(); ++f)
                changed += before[f] != result.chart[f] ? 1 : 0;
        }
        result.converged = changed < converged_share * mesh.face_count();
        if (result.converged || result.rounds == options.max_iterations)
            return;
        reseed(mesh, result.chart, seeds);
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
        mesh, [&](HalfEdge h) { return is_open(h / 3) && is_open(mesh.twin[h] / 3); });
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
            const Index opposite = mesh.twin[h];
            hole.touches_chart |= opposite >= 0 && !is_open(opposite / 3);
        }
    }
    return holes;
}

// A chart of its own for a large hole: proxy and seed from all its faces, regrown within it.
void add_hole_chart(const Mesh& mesh, const DChartsOptions& options, const Hole& hole,
                    Growth& growth, std::vector<Seed>& seeds, DChartsResult& result,
                    Progress& progress) {
    metrics::NormalMoments moments;
    for (const Face f : hole.faces)
        moments.add(mesh.face_areas[f], mesh.face_normals[f]);
    Seed seed;
    seed.proxy = metrics::fit_conic(moments);
    std::vector<double> errors;
    seed.face = next_seed(mesh, hole.faces, seed.proxy, errors);
    const Index label = static_cast<Index>(seeds.size());
    seeds.push_back(seed);
    result.chart[seed.face] = label;
    ++result.hole_charts;
    growth.run(seeds, options.max_fitting_error, {seed.face}, {seed.face}, result.chart, progress);
}

// [JKS05, section 3.2]: large holes get charts, which may leave holes again; then the small ones
// are filled by the charts around them, whatever the fitting error.
void fill_holes(const Mesh& mesh, const DChartsOptions& options, Growth& growth,
                std::vector<Seed>& seeds, DChartsResult& result, Progress& progress) {
    const double small_area =
        small_hole_share * mesh.total_area / static_cast<double>(options.charts_number);
    for (bool added = true; added;) {
        added = false;
        for (const Hole& hole : find_holes(mesh, result.chart))
            if (hole.area >= small_area || !hole.touches_chart) {
                add_hole_chart(mesh, options, hole, growth, seeds, result, progress);
                added = true;
            }
        progress.update(0.5);
    }
    std::vector<Index> front;
    for (const Face f : mesh.all_faces()) {
        if (result.chart[f] < 0)
            continue;
        for (const HalfEdge h : half_edges_of(f)) {
            const Index opposite = mesh.twin[h];
            if (opposite >= 0 && result.chart[opposite / 3] < 0) {
                front.push_back(f);
                break;
            }
        }
    }
    if (!front.empty())
        growth.run(seeds, unbounded, front, {}, result.chart, progress);
}

} // namespace

void check_options(const Mesh& mesh, const DChartsOptions& o) {
    if (o.charts_number < 1 || o.charts_number > mesh.face_count())
        refuse("charts_number",
               "a number from 1 to " + std::to_string(mesh.face_count()) + " (the number of faces)",
               o.charts_number);
    if (!(o.max_fitting_error > 0.0) || !(o.max_fitting_error <= 4.0))
        refuse("max_fitting_error", "a number above 0 and at most 4 (0.2 is usual)",
               o.max_fitting_error);
    const auto exponent = [](const char* name, double value) {
        if (!(value >= 0.0) || !(value <= 10.0))
            refuse(name, "a number from 0 to 10", value);
    };
    exponent("alpha", o.alpha);
    exponent("beta", o.beta);
    exponent("gamma", o.gamma);
    if (o.max_iterations < 1)
        refuse("max_iterations", "a number of at least 1", o.max_iterations);
    if (o.random_seed < 0)
        refuse("random_seed", "a number of at least 0", o.random_seed);
}

DChartsResult segment_dcharts(const Mesh& mesh, const DChartsOptions& options, Progress& progress) {
    check_options(mesh, options);
    DChartsResult result;

    progress.begin_phase("placing seeds", 0.1);
    std::vector<Seed> seeds;
    for (const Face face :
         growth::farthest_point_seeds(mesh, options.charts_number,
                                      static_cast<std::uint32_t>(options.random_seed), progress))
        seeds.push_back(initial_seed(mesh, face));

    progress.begin_phase("growing charts", 0.6);
    Growth growth(mesh, options);
    lloyd(mesh, options, growth, seeds, result, progress);

    progress.begin_phase("filling holes", 0.1);
    fill_holes(mesh, options, growth, seeds, result, progress);

    result.proxies = metrics::fit_conics(mesh, result.chart, static_cast<Index>(seeds.size()));
    result.fitting_error.resize(mesh.faces.size());
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        result.fitting_error[f] =
            result.proxies[result.chart[f]].fitting_error(mesh.face_normals[f]);
    return result;
}

} // namespace devseg::dcharts
