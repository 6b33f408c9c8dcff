// Seeds: start faces that are far from one another along the surface, and the next ones, in the
// middle of their charts.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/mesh/mesh.h"

namespace devseg::growth {

/// `count` distinct faces; each next one is farthest from those before, along paths over face
/// centroids; other connected components count as infinitely far. Seed value 0 starts at the face
/// farthest from the centre of the surface, whatever the order of the faces; other values start
/// at a random face. No two are of one facet.
std::vector<Index> farthest_point_seeds(const Mesh& mesh, Index count, std::uint32_t random_seed,
                                        Progress& progress, const mesh::Facets& facets = {});

/// Charts never join components: as many charts as asked for, and at least one for each component.
inline Index at_least_one_per_component(const Mesh& mesh, int charts_number) {
    return std::max(static_cast<Index>(charts_number),
                    mesh::face_components(mesh, [](Index) { return true; }).count);
}

// The Lloyd–Max step of t-flooding and Multi-Chart Geometry Images: a chart's next seed is its face
// farthest from its border.

/// Of each chart: the face farthest from its border, and how far that is.
struct FarthestFaces {
    std::vector<Index> face;
    std::vector<float> distance; // −1 for charts without a border
};

class BorderDistance {
public:
    explicit BorderDistance(const Mesh& mesh) : mesh_(mesh), paths_(mesh.faces.size()) {}

    /// The face of each chart that is farthest from the chart's border, along paths inside the
    /// chart whose step across half-edge h costs step(h) ≥ 0. `chart` holds a label for each face,
    /// `seeds` a face for each chart, which stays where a chart has no border.
    template <class Step>
    FarthestFaces farthest_faces(const std::vector<Index>& chart, const std::vector<Index>& seeds,
                                 Step step, const Progress& progress) {
        const auto inside = [&](HalfEdge h) {
            return mesh_.twin[h] >= 0 && chart[face_of(mesh_.twin[h])] == chart[face_of(h)];
        };
        paths_.clear();
        for (const HalfEdge h : mesh_.all_half_edges())
            if (!inside(h) && paths_.distance[face_of(h)] > 0.0F)
                paths_.add_source(face_of(h));
        FarthestFaces farthest{seeds, std::vector<float>(seeds.size(), -1.0F)};
        paths_.run(
            [&](Face f, float distance) {
                const Index c = chart[f];
                if (distance > farthest.distance[c]) {
                    farthest.distance[c] = distance;
                    farthest.face[c] = f;
                }
                for (const HalfEdge h : half_edges_of(f))
                    if (inside(h))
                        paths_.reach(face_of(mesh_.twin[h]), distance + step(h));
            },
            progress);
        return farthest;
    }

private:
    const Mesh& mesh_;
    graph::ShortestPaths<float> paths_; // #F
};

} // namespace devseg::growth
