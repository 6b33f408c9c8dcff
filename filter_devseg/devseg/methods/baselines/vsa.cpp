#include "devseg/methods/baselines/baselines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "devseg/methods/growth/growth.h"
#include "devseg/methods/growth/seeds.h"

namespace devseg::baselines {

namespace {

struct VsaTuning {
    // Rounds end when the error falls by less than this share; Lloyd rounds go on for very long
    // with changes of single faces.
    double least_gain = 1e-3;
    // [CSAD04, section 3.5]: a teleport pays if merging costs less than this share of what the
    // worst chart's error is.
    double teleport_share = 0.5;
    // Faces whose errors differ by no more than the rounding of sums count as equal: the one that
    // lies first along the axes is taken then, so that the order of faces does not decide.
    double same_deviation = 1e-12;
};
constexpr VsaTuning tuning;

// Area and normal of a face in single precision, side by side: 16 bytes that a step reads at once.
struct FaceNormal {
    float x, y, z, area;
};

class ProxyCost {
public:
    explicit ProxyCost(const Mesh& mesh) : mesh_(mesh) {
        for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
            const Vec3& n = mesh.face_normals[f];
            faces_.push_back({static_cast<float>(n.x()), static_cast<float>(n.y()),
                              static_cast<float>(n.z()), static_cast<float>(mesh.face_areas[f])});
        }
    }
    void set_proxies(const std::vector<Vec3>& proxies) {
        proxies_.clear();
        for (const Vec3& n : proxies)
            proxies_.push_back(n.cast<float>());
    }

    // The error of [CSAD04, section 2.3]: |t| · |n − N|².
    growth::CandidateHeap::Entry candidate(HalfEdge h, Index c) const {
        const Face f = face_of(mesh_.twin[h]);
        const FaceNormal& n = faces_[f];
        const Eigen::Vector3f& proxy = proxies_[c];
        const float dx = n.x - proxy.x();
        const float dy = n.y - proxy.y();
        const float dz = n.z - proxy.z();
        const float error = n.area * (dx * dx + dy * dy + dz * dz);
        return {error, error, f};
    }
    float key(Index, const growth::CandidateHeap::Entry& entry) const { return entry.key; }
    void take(Index, Index, float) const {}

private:
    const Mesh& mesh_;
    std::vector<FaceNormal> faces_; // #F
    std::vector<Eigen::Vector3f> proxies_;
};

bool lies_before(const Mesh& mesh, Face f, Index g) {
    const Vec3& a = mesh.face_centers[f];
    const Vec3& b = mesh.face_centers[g];
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

double squared_deviation(const Mesh& mesh, Face f, const Vec3& proxy) {
    return (mesh.face_normals[f] - proxy).squaredNorm();
}

// The partition at hand: with the area-weighted sums of normals, a chart's error and that of two
// charts merged come without a walk over faces. Σ A |n − N|² is least for N along Σ A n, and is
// then 2 (Σ A − |Σ A n|).
struct Partition {
    std::vector<Index> chart; // #F
    std::vector<Vec3> normal_sum;
    std::vector<double> area;
    double total = 0.0;

    double error(std::size_t c) const { return 2.0 * (area[c] - normal_sum[c].norm()); }
    double merged_error(std::size_t a, std::size_t b) const {
        return 2.0 * (area[a] + area[b] - (normal_sum[a] + normal_sum[b]).norm());
    }
    Index worst() const {
        std::size_t result = 0;
        for (std::size_t c = 1; c < area.size(); ++c)
            if (error(c) > error(result))
                result = c;
        return static_cast<Index>(result);
    }
};

class Approximation {
public:
    Approximation(const Mesh& mesh, const mesh::Facets& facets, Progress& progress)
        : mesh_(mesh), facets_(facets), progress_(progress), cost_(mesh), heaps_(mesh, facets) {}

    void partition() {
        cost_.set_proxies(proxies_);
        heaps_.grow(seeds_, cost_, now_.chart, progress_);
        sum_up();
    }

    // Proxies of the charts at hand, and for each the face that fits best as the next seed.
    void fit() {
        for (std::size_t c = 0; c < proxies_.size(); ++c)
            if (now_.normal_sum[c].squaredNorm() > 0.0)
                proxies_[c] = now_.normal_sum[c].normalized();
        std::vector<double> least(seeds_.size(), infinite);
        for (const Face f : mesh_.all_faces()) {
            const std::size_t c = at(now_.chart[f]);
            const double deviation =
                std::sqrt(mesh_.face_areas[f] * squared_deviation(mesh_, f, proxies_[c]));
            const bool same = std::abs(deviation - least[c]) <= tuning.same_deviation;
            if (same ? lies_before(mesh_, f, seeds_[c]) : deviation < least[c]) {
                least[c] = deviation;
                seeds_[c] = f;
            }
        }
    }

    // Two charts in place of the worst one: around its best face, and around the face that differs
    // most from that. Both start from their own normal, as the mean of two flat sides would keep
    // one chart from reaching its side. False where all faces agree.
    bool split_worst() {
        const Index worst = now_.worst();
        const Vec3 normal = mesh_.face_normals[seeds_[worst]];
        Index farthest = -1;
        double largest = 0.0;
        for (const Face f : mesh_.all_faces()) {
            if (now_.chart[f] != worst || facets_.are_one(f, seeds_[worst]))
                continue;
            const double deviation =
                std::sqrt(mesh_.face_areas[f] * squared_deviation(mesh_, f, normal));
            const bool same =
                farthest >= 0 && std::abs(deviation - largest) <= tuning.same_deviation;
            if (same ? lies_before(mesh_, f, farthest) : deviation > largest) {
                largest = deviation;
                farthest = f;
            }
        }
        if (farthest < 0)
            return false;
        proxies_[worst] = normal;
        add(farthest);
        return true;
    }

    /// The first of `candidates` that is no seed yet; there must be one.
    void add_unused(const std::vector<Index>& candidates) {
        add(*std::find_if(candidates.begin(), candidates.end(), [&](Face f) {
            return std::none_of(seeds_.begin(), seeds_.end(),
                                [&](Face seed) { return facets_.are_one(f, seed); });
        }));
    }

    void add(Index seed) {
        seeds_.push_back(seed);
        proxies_.push_back(mesh_.face_normals[seed]);
    }

    // [CSAD04, section 3.5]: the two neighbours that are most alike become one chart, and the
    // worst chart becomes two. False where that would not pay.
    bool teleport() {
        const std::size_t worst = at(now_.worst());
        double least = tuning.teleport_share * now_.error(worst);
        std::pair<std::size_t, std::size_t> pair(0, 0);
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin < h)
                continue;
            const auto [a, b] =
                std::minmax({at(now_.chart[face_of(h)]), at(now_.chart[face_of(twin)])});
            if (a == b || a == worst || b == worst)
                continue;
            const double increase = now_.merged_error(a, b) - now_.error(a) - now_.error(b);
            if (increase < least || (increase == least && std::pair(a, b) < pair)) {
                least = increase;
                pair = {a, b};
            }
        }
        if (pair.first == pair.second || !split_worst())
            return false;
        const auto [kept, dropped] = pair;
        if ((now_.normal_sum[kept] + now_.normal_sum[dropped]).squaredNorm() > 0.0)
            proxies_[kept] = (now_.normal_sum[kept] + now_.normal_sum[dropped]).normalized();
        proxies_.erase(proxies_.begin() + static_cast<std::ptrdiff_t>(dropped));
        seeds_.erase(seeds_.begin() + static_cast<std::ptrdiff_t>(dropped));
        return true;
    }

    const Partition& now() const { return now_; }
    const std::vector<Vec3>& proxies() const { return proxies_; }

private:
    void sum_up() {
        now_.normal_sum.assign(seeds_.size(), Vec3::Zero());
        now_.area.assign(seeds_.size(), 0.0);
        for (const Face f : mesh_.all_faces()) {
            const Index c = now_.chart[f];
            if (c < 0)
                continue;
            now_.normal_sum[c] += mesh_.face_areas[f] * mesh_.face_normals[f];
            now_.area[c] += mesh_.face_areas[f];
        }
        now_.total = 0.0;
        for (std::size_t c = 0; c < seeds_.size(); ++c)
            now_.total += now_.error(c);
    }

    const Mesh& mesh_;
    const mesh::Facets& facets_;
    Progress& progress_;
    ProxyCost cost_;
    growth::MultiHeap<growth::Offers::first> heaps_;
    std::vector<Index> seeds_;
    std::vector<Vec3> proxies_;
    Partition now_;
};

// The start of [CSAD04, section 3.2]: one chart more at a time, where the error is largest; what no
// error tells apart (planes) gets seeds that are far from each other. Random starts take the latter
// everywhere.
void start(const Mesh& mesh, const mesh::Facets& facets, Index count, int random_seed,
           Approximation& approximation, Progress& progress) {
    const Index components = mesh::face_components(mesh, [](Index) { return true; }).count;
    const std::vector<Index> far = growth::farthest_point_seeds(
        mesh, count, static_cast<std::uint32_t>(random_seed), progress, facets);
    Index charts = 0;
    for (; charts < (random_seed != 0 ? count : components); ++charts)
        approximation.add(far[charts]);
    for (;; ++charts) {
        approximation.partition();
        approximation.fit();
        progress.update(static_cast<double>(charts) / count);
        if (charts == count)
            return;
        if (!approximation.split_worst())
            approximation.add_unused(far);
    }
}

// Lloyd rounds until the error settles, then a teleport, and so on while that helps.
void approximate(const VsaOptions& options, Approximation& approximation, VsaResult& result,
                 Progress& progress) {
    double before = infinite; // not known yet
    double before_teleport = infinite;
    result.total_error = infinite;
    while (result.rounds < options.max_iterations) {
        approximation.partition();
        ++result.rounds;
        progress.update(static_cast<double>(result.rounds) / options.max_iterations);
        const Partition& now = approximation.now();
        if (now.total < result.total_error) {
            result.total_error = now.total;
            result.chart = now.chart;
        }
        approximation.fit();
        const bool settled = now.total >= (1.0 - tuning.least_gain) * before;
        before = now.total;
        if (!settled)
            continue;
        result.converged = !options.teleport_charts || result.total_error >= before_teleport ||
                           !approximation.teleport();
        if (result.converged)
            return;
        ++result.teleports;
        before_teleport = result.total_error;
        before = infinite;
    }
}

} // namespace

VsaResult segment_vsa(const Mesh& mesh, const VsaOptions& options, Progress& progress) {
    check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    const Index count = growth::at_least_one_per_component(mesh, options.charts_number);
    const mesh::Facets facets(mesh, count);
    Approximation approximation(mesh, facets, progress);
    auto placing = progress.part("placing seeds", 0.3);
    start(mesh, facets, count, options.random_seed, approximation, placing);

    auto fitting = progress.part("fitting planes", 0.7);
    VsaResult result;
    approximate(options, approximation, result, fitting);
    result.proxies.assign(at(count), Vec3::Zero());
    for (const Face f : mesh.all_faces())
        result.proxies[result.chart[f]] += mesh.face_areas[f] * mesh.face_normals[f];
    for (Vec3& proxy : result.proxies)
        proxy = proxy.squaredNorm() > 0.0 ? Vec3(proxy.normalized()) : Vec3::UnitZ();
    for (const Face f : mesh.all_faces())
        result.face_error.push_back(squared_deviation(mesh, f, result.proxies[result.chart[f]]));
    return result;
}

} // namespace devseg::baselines
