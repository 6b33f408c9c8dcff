#include "devseg/methods/growth/seeds.h"

#include <random>

namespace devseg::growth {

namespace {

// How far faces are from the centre of the surface.
class Remoteness {
public:
    explicit Remoteness(const Mesh& mesh) : mesh_(mesh), centre_(Vec3::Zero()) {
        for (const Face f : mesh.all_faces())
            centre_ += mesh.face_areas[f] * mesh.face_centers[f];
        centre_ /= mesh.total_area;
    }
    double operator()(Face f) const { return (mesh_.face_centers[f] - centre_).squaredNorm(); }

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
    for (Face f = 1; f < mesh.face_count(); ++f)
        if (remoteness(f) > remoteness(best))
            best = f;
    return best;
}

} // namespace

std::vector<Index> farthest_point_seeds(const Mesh& mesh, Index count, std::uint32_t random_seed,
                                        Progress& progress, const mesh::Facets& facets) {
    graph::ShortestPaths<> paths(mesh.faces.size()); // over centroids, from the seeds up to here
    const std::vector<double>& distance = paths.distance;
    std::vector<Index> seeds;
    seeds.reserve(at(count));
    const Remoteness remoteness(mesh);
    Index next = first_seed(mesh, remoteness, random_seed);
    while (true) {
        seeds.push_back(next);
        if (static_cast<Index>(seeds.size()) == count)
            return seeds;
        progress.update(static_cast<double>(seeds.size()) / count);
        paths.add_source(next);
        for (const Face f : facets.around(next))
            paths.add_source(f);
        paths.run([&](Face f, double to_f) {
            for (const HalfEdge h : half_edges_of(f))
                if (mesh.twin[h] >= 0) {
                    const Face g = face_of(mesh.twin[h]);
                    paths.reach(g, to_f + (mesh.face_centers[g] - mesh.face_centers[f]).norm());
                }
        });
        for (const Face f : mesh.all_faces())
            if (distance[f] > distance[next] ||
                // a component without seeds: not the first of its faces, but the most remote
                (distance[f] == infinite && distance[next] == infinite &&
                 remoteness(f) > remoteness(next)))
                next = f;
        if (distance[next] <= 0.0) { // centroids coincide: any face that is not a seed yet
            std::vector<std::uint8_t> taken(mesh.faces.size(), 0);
            for (const Index s : seeds) {
                taken[s] = 1;
                for (const Face f : facets.around(s))
                    taken[f] = 1;
            }
            for (next = 0; taken[next] != 0;)
                ++next;
        }
    }
}

} // namespace devseg::growth
