#include "devseg/methods/baselines/baselines.h"

#include <algorithm>
#include <set>

#include "devseg/methods/growth/growth.h"
#include "devseg/methods/growth/seeds.h"

namespace devseg::baselines {

namespace {

// λ of [SWGSH03, section 4.1]: compact against planar charts.
constexpr double compactness = 1.0;

class PathCost {
public:
    explicit PathCost(const Mesh& mesh) : mesh_(mesh), cost_(mesh.faces.size(), 0.0F) {
        distance_.resize(mesh.twin.size(), 0.0F);
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] >= 0)
                distance_[h] = static_cast<float>(
                    (mesh.face_centers[face_of(h)] - mesh.face_centers[face_of(mesh.twin[h])])
                        .norm());
    }

    void start_over(std::size_t charts) {
        normal_sum_.assign(charts, Vec3::Zero());
        normal_.assign(charts, Vec3::UnitZ());
    }

    growth::CandidateHeap::Entry candidate(HalfEdge h, Index c) const {
        const float cost = cost_[face_of(h)] + step(h, c);
        return {cost, cost, face_of(mesh_.twin[h])};
    }
    float key(Index, const growth::CandidateHeap::Entry& entry) const { return entry.key; }
    void take(Face f, Index c, float cost) {
        cost_[f] = cost;
        last_ = f;
        // Seeds without area count as well: every chart has a normal from its first face on.
        Vec3& sum = normal_sum_[c];
        sum += mesh_.face_areas[f] * mesh_.face_normals[f];
        normal_[c] = sum.squaredNorm() > 0.0 ? Vec3(sum.normalized()) : mesh_.face_normals[f];
    }

    float step(HalfEdge h, Index c) const {
        const Vec3& normal = mesh_.face_normals[face_of(mesh_.twin[h])];
        return distance_[h] * static_cast<float>(compactness + 1.0 - normal_[c].dot(normal));
    }
    /// The face that was taken last: the one that costs most.
    Index last() const { return last_; }
    const std::vector<float>& cost() const { return cost_; }

private:
    const Mesh& mesh_;
    std::vector<float> cost_;     // #F: of the path from the seed
    std::vector<float> distance_; // 3 #F: of the centroids on both sides
    std::vector<Vec3> normal_sum_;
    std::vector<Vec3> normal_; // of each chart, as far as it has grown
    Index last_ = -1;
};

} // namespace

McgimResult segment_mcgim(const Mesh& mesh, const McgimOptions& options, Progress& progress) {
    check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    const Index count = growth::at_least_one_per_component(mesh, options.charts_number);
    const Index components = mesh::face_components(mesh, [](Index) { return true; }).count;

    // One chart more at a time, from the face that was reached last [SWGSH03, section 4.1].
    auto placing = progress.part("placing seeds", 0.3);
    const mesh::Facets facets(mesh, count);
    std::vector<Index> seeds = growth::farthest_point_seeds(
        mesh, components, static_cast<std::uint32_t>(options.random_seed), placing, facets);
    McgimResult result;
    PathCost cost(mesh);
    growth::MultiHeap<growth::Offers::best> heaps(mesh, facets);
    const auto grow = [&](Progress& part) {
        cost.start_over(seeds.size());
        heaps.grow(seeds, cost, result.chart, part);
    };
    while (static_cast<Index>(seeds.size()) < count) {
        grow(placing);
        seeds.push_back(cost.last());
        placing.update(static_cast<double>(seeds.size()) / count);
    }

    auto growing = progress.part("growing charts", 0.7);
    growth::BorderDistance border(mesh);
    std::set<std::vector<Index>> seen{seeds};
    while (true) {
        grow(growing);
        ++result.rounds;
        growing.update(static_cast<double>(result.rounds) / options.max_iterations);
        if (result.rounds == options.max_iterations)
            break;
        seeds = border
                    .farthest_faces(
                        result.chart, seeds,
                        [&](HalfEdge h) { return cost.step(h, result.chart[face_of(h)]); }, growing)
                    .face;
        result.converged = !seen.insert(seeds).second;
        if (result.converged)
            break;
    }
    result.face_cost.assign(cost.cost().begin(), cost.cost().end());
    return result;
}

} // namespace devseg::baselines
