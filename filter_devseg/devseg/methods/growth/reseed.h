// The Lloyd–Max step of t-flooding and Multi-Chart Geometry Images: a chart's next seed is its face
// farthest from its border.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/methods/growth/growth.h"

namespace devseg::growth {

class BorderDistance {
public:
    explicit BorderDistance(const Mesh& mesh) : mesh_(mesh) {}

    /// The face of each chart that is farthest from the chart's border, along paths inside the
    /// chart whose step across half-edge h costs step(h) ≥ 0. `chart` holds a label for each face,
    /// `seeds` a face for each chart, which stays where a chart has no border.
    template <class Step>
    std::vector<Index> farthest_faces(const std::vector<Index>& chart,
                                      const std::vector<Index>& seeds, Step step,
                                      Progress& progress) {
        start(chart);
        std::vector<Index> farthest = seeds;
        std::vector<float> largest(seeds.size(), -1.0F);
        for (Index settled = 0; !heap_.empty();) {
            const CandidateHeap::Entry entry = heap_.top();
            heap_.pop();
            const Face f = entry.face;
            if (entry.key > distance_[f])
                continue;
            if (++settled % update_every == 0)
                progress.update(0.0);
            const Index c = chart[f];
            // Faces come in the order of their distance; of equals the lowest number counts.
            if (entry.key > largest[c]) {
                largest[c] = entry.key;
                farthest[c] = f;
            }
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0 || chart[twin / 3] != c)
                    continue;
                const float through = entry.key + step(h);
                if (through < distance_[twin / 3]) {
                    distance_[twin / 3] = through;
                    heap_.push({through, through, twin / 3});
                }
            }
        }
        return farthest;
    }

private:
    void start(const std::vector<Index>& chart) {
        distance_.assign(chart.size(), std::numeric_limits<float>::infinity());
        heap_.clear();
        for (const Face f : mesh_.all_faces())
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0 || chart[twin / 3] != chart[f]) {
                    distance_[f] = 0.0F;
                    heap_.push({0.0F, 0.0F, f});
                    break;
                }
            }
    }

    static constexpr Index update_every = 4096; // faces between two looks at the progress object

    const Mesh& mesh_;
    std::vector<float> distance_; // #F
    CandidateHeap heap_;
};

} // namespace devseg::growth
