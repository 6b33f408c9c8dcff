#include "devseg/methods/growth/seeds.h"

#include <functional>
#include <limits>
#include <queue>
#include <random>

namespace devseg::growth {

namespace {

using QueueEntry = std::pair<double, Index>;
using MinQueue = std::priority_queue<QueueEntry, std::vector<QueueEntry>, std::greater<>>;

// Lowers `distance` to the distance from `source` where that is less (Dijkstra over centroids).
void relax_from(const Mesh& mesh, Index source, std::vector<double>& distance, MinQueue& queue) {
    distance[at(source)] = 0.0;
    queue.emplace(0.0, source);
    while (!queue.empty()) {
        const auto [d, f] = queue.top();
        queue.pop();
        if (d > distance[at(f)])
            continue;
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            const Index opposite = mesh.twin[at(h)];
            if (opposite < 0)
                continue;
            const Index g = opposite / 3;
            const double through = d + (mesh.face_centers[at(g)] - mesh.face_centers[at(f)]).norm();
            if (through < distance[at(g)]) {
                distance[at(g)] = through;
                queue.emplace(through, g);
            }
        }
    }
}

// How far faces are from the centre of the surface.
class Remoteness {
public:
    explicit Remoteness(const Mesh& mesh) : mesh_(mesh), centre_(Vec3::Zero()) {
        for (Index f = 0; f < mesh.face_count(); ++f)
            centre_ += mesh.face_areas[at(f)] * mesh.face_centers[at(f)];
        centre_ /= mesh.total_area;
    }
    double operator()(Index f) const { return (mesh_.face_centers[at(f)] - centre_).squaredNorm(); }

private:
    const Mesh& mesh_;
    Vec3 centre_;
};

Index first_seed(const Mesh& mesh, const Remoteness& remoteness, std::uint32_t random_seed) {
    if (random_seed != 0) {
        std::mt19937 generator(random_seed);
        // Not a std distribution: those differ between standard libraries.
        return static_cast<Index>(generator() % static_cast<std::uint32_t>(mesh.face_count()));
    }
    Index best = 0;
    for (Index f = 1; f < mesh.face_count(); ++f)
        if (remoteness(f) > remoteness(best))
            best = f;
    return best;
}

} // namespace

std::vector<Index> farthest_point_seeds(const Mesh& mesh, Index count, std::uint32_t random_seed,
                                        Progress& progress) {
    std::vector<double> distance(mesh.faces.size(), infinite);
    MinQueue queue;
    std::vector<Index> seeds;
    seeds.reserve(at(count));
    const Remoteness remoteness(mesh);
    Index next = first_seed(mesh, remoteness, random_seed);
    while (true) {
        seeds.push_back(next);
        if (static_cast<Index>(seeds.size()) == count)
            return seeds;
        progress.update(static_cast<double>(seeds.size()) / count);
        relax_from(mesh, next, distance, queue);
        for (Index f = 0; f < mesh.face_count(); ++f)
            if (distance[at(f)] > distance[at(next)] ||
                // a component without seeds: not the first of its faces, but the most remote
                (distance[at(f)] == infinite && distance[at(next)] == infinite &&
                 remoteness(f) > remoteness(next)))
                next = f;
        if (distance[at(next)] <= 0.0) { // centroids coincide: any face that is not a seed yet
            std::vector<std::uint8_t> taken(mesh.faces.size(), 0);
            for (const Index s : seeds)
                taken[at(s)] = 1;
            for (next = 0; taken[at(next)] != 0;)
                ++next;
        }
    }
}

} // namespace devseg::growth
